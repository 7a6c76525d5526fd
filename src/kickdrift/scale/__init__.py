"""Many runs: members of one problem, on all cores of a machine or on the workers of an executor."""
