"""Settings of the interpreter that make the time of a control tick steady.

They do not change any result.
"""

import gc
from collections.abc import Iterator
from contextlib import contextmanager

from threadpoolctl import ThreadpoolController

_LINEAR_ALGEBRA = ThreadpoolController()


@contextmanager
def steady_ticks() -> Iterator[None]:
    """Limits numpy's linear algebra to one thread, and stops cyclic garbage collection.

    The threads of the libraries behind numpy are meant for large matrices: with the
    small matrices of a control tick they take a third of its time. The values that pass
    through a diagram are frozen and without cycles, so that reference counts free them;
    the collector would only traverse them, for milliseconds at a time.
    """
    collecting = gc.isenabled()
    gc.disable()
    try:
        with _LINEAR_ALGEBRA.limit(limits=1, user_api="blas"):
            yield
    finally:
        if collecting:
            gc.enable()
