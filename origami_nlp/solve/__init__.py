"""Starts, IPOPT, Newton polish and the multi-start search."""
