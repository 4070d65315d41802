"""Rules that say which solvers are worth trying on a problem, made of campaigns and tried on families that they were
not made of: data/recommendation.json (benchmarks/RESULTS.md), which `lcpbench recommend` reads."""
