"""Design of benches from a joint survey: reliability, backbreak, volume, berm and inter-ramp angle."""

from slopekit.studies.bench_design.run import BenchDesigns, bench_design

__all__ = ["BenchDesigns", "bench_design"]
