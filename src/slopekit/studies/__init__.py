"""Studies, which analyse a design many times: checks, sweeps, samples. Each study is a noun and a verb."""
