"""The sheet of a result, of one block and of many: `Result.sheet` loads it when it is asked for."""
