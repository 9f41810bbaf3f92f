"""Threads that begin and end within microseconds what they are asked for.

A sleeping thread takes tens of microseconds to wake, and so does one that waits for Python's lock; a control period of
a batch takes a few hundred to compute. So helpers stay in compiled code, look out for a while for what comes next, and
only then go to sleep.
"""

from __future__ import annotations

import atexit
from collections.abc import Callable, Sequence
from threading import Event, Lock, Thread

import numpy as np

from fo_gym.binding import Bound
from fo_gym.mail import ASKED, DONE, ENTRIES, ask, has_done, serve, tell

_LOOKS = 1_000_000
"""How often one looks before one gives up: some hundred microseconds, in which who steps a batch comes back."""

_PAUSE = 20_000
"""Looks for which a helper lets who asked leave Python's lock: about five microseconds; to wait for it takes thirty."""

Work = Callable[[], object]

__all__ = ["Crew"]


class _Helper:
    """A thread that does what it is asked for."""

    def __init__(self, number: int) -> None:
        self._mail = np.zeros(ENTRIES, dtype=np.int64)
        self._work: Work
        self._failed: BaseException | None = None
        self._sleeping, self._lock, self._bell = False, Lock(), Lock()
        self._bell.acquire()
        self._never = Event()
        self._engaged, self._thread = True, Thread(target=self._live, name=f"fo-gym-{number}", daemon=True)
        self._thread.start()

    def _live(self) -> None:
        while self._engaged:
            if serve(self._mail, _LOOKS, _PAUSE):
                try:
                    self._work()
                except BaseException as error:  # raised where it was asked for
                    self._failed = error
                tell(self._mail)
            else:
                self._sleep()

    def _sleep(self) -> None:
        with self._lock:
            self._sleeping = bool(self._mail[ASKED] == self._mail[DONE])
            asleep = self._sleeping
        if asleep:
            self._bell.acquire()

    def ask(self, work: Work) -> None:
        """Ask for a call of this, when what was asked for before is done."""
        if isinstance(work, Bound):
            ask(self._mail, work.address, work.args[0])
        else:
            self._work = work
            ask(self._mail, 0, 0)
        with self._lock:
            asleep, self._sleeping = self._sleeping, False
        if asleep:
            self._bell.release()

    def wait(self) -> None:
        """Come back when it is done."""
        while not has_done(self._mail, _LOOKS):
            self._never.wait(1e-5)  # there are more threads than processors: one of them makes room

    def dismiss(self) -> None:
        """End the thread."""
        self._engaged = False
        self.ask(lambda: None)
        self._thread.join()

    def check(self) -> None:
        """Raise what its work raised."""
        failed, self._failed = self._failed, None
        if failed is not None:
            raise failed


class Crew:
    """This thread and its helpers.

    Args:
        helpers: how many.
    """

    def __init__(self, helpers: int) -> None:
        self._helpers = [_Helper(number) for number in range(helpers)]
        self._busy = Lock()
        atexit.register(self._dismiss)  # what is compiled is gone before the threads are

    def _dismiss(self) -> None:
        for helper in self._helpers:
            helper.dismiss()

    def run(self, works: Sequence[Work]) -> None:
        """Call all of them, the first one here, one more than there are helpers; where these are busy, all here.

        Bound functions need nothing of Python, and begin at once. Others should leave Python's lock soon.

        Raises:
            BaseException: what one of them raised, when all of them are done.
        """
        if not self._busy.acquire(blocking=False):
            for work in works:
                work()
            return
        try:
            try:
                for helper, work in zip(self._helpers, works[1:], strict=True):
                    helper.ask(work)
                works[0]()
            finally:
                for helper in self._helpers:
                    helper.wait()
            for helper in self._helpers:
                helper.check()
        finally:
            self._busy.release()
