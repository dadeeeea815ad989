"""Many scenes: a sweep over parameters, run on any executor, stored as it goes."""
