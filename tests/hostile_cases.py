"""A fuzzer whose cases hold, crash, hang, fail and are wrong, in this order: what `hostile.tried` has to tell apart."""

import os
import signal
import time


def attempt(seed):
    """Do what the seed says."""
    match seed:
        case 1:
            os.kill(os.getpid(), signal.SIGSEGV)
        case 2:
            time.sleep(60)
        case 3:
            return 1 / 0
        case 4:
            return "failed in words"
    return None
