"""What is done with many analyses of a design: checks, sweeps, samples. Each study is a noun and a verb."""
