"""What a solved state is: multipliers, certificates, and the minima of a scene."""
