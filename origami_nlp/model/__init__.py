"""The scene as a nonlinear programme: closure, contact and energy in CasADi; geometry of folded states."""
