"""The ground floor: compile flags, errors, outcomes, constants."""
