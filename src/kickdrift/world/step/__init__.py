"""The step of a world: the order of its stages, their compilation, the loop that runs them, rollback and subdivision."""
