"""The limit of many blocks: bonds that break, groups, what fails first and what next."""
