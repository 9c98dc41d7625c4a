"""Settings of the interpreter under which a control tick takes a steady time.

About the machine, not about robots: nothing here changes a result.
"""

import gc
from collections.abc import Iterator
from contextlib import contextmanager

from threadpoolctl import ThreadpoolController

_LINEAR_ALGEBRA = ThreadpoolController()


@contextmanager
def steady_ticks() -> Iterator[None]:
    """One thread for numpy's linear algebra, and no cyclic garbage collection.

    The threads of the libraries behind numpy are meant for large matrices: on the
    small ones of a control tick they cost a third of it. The values that pass through
    a diagram are frozen and without cycles, so that reference counts free them; the
    collector only looks through all of them, milliseconds at a time.
    """
    collecting = gc.isenabled()
    gc.disable()
    try:
        with _LINEAR_ALGEBRA.limit(limits=1, user_api="blas"):
            yield
    finally:
        if collecting:
            gc.enable()
