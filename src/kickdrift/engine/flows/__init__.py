"""The flows: each advances the state under one part of the dynamics, in place, and allocates nothing."""
