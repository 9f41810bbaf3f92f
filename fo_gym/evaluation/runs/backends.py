"""Who does the work: processes of this machine (joblib), or the workers of a Ray cluster. The results are the same."""

from __future__ import annotations

import importlib
import os
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext, suppress
from dataclasses import dataclass
from typing import Any, Literal, Protocol, TypeVar

from joblib import Parallel, cpu_count, delayed
from joblib.externals.loky.process_executor import TerminatedWorkerError

from fo_gym.envs.registry import import_sources, sources
from fo_gym.evaluation.runs.allocator import keep_freed_memory
from fo_gym.extras import install_command

T = TypeVar("T")
Task = tuple[Any, ...]
Name = Literal["joblib", "ray"]

RETRIES = 2
"""How often Ray starts a task again whose worker died."""

# Ray phones home and warns about devices unless told otherwise before it is imported.
_RAY_ENVIRONMENT = {"RAY_USAGE_STATS_ENABLED": "0", "RAY_ACCEL_ENV_VAR_OVERRIDE_ON_ZERO": "0"}

__all__ = ["RETRIES", "Backend", "BackendError", "Name", "Processes", "RayWorkers", "backend_of"]


class BackendError(RuntimeError):
    """The workers cannot be had, or were lost; the message says what to do."""


class Backend(Protocol):
    """Runs independent tasks."""

    @property
    def workers(self) -> int:
        """How many tasks run at a time."""

    def run(self, function: Callable[..., T], tasks: Sequence[Task]) -> Iterator[tuple[int, T | None]]:
        """Call `function` with the arguments of every task.

        Args:
            function: importable by its name; what it raises is raised here.
            tasks: arguments, one tuple per call.

        Yields:
            Place of a task and its result, in the order in which they come; None for one that ended its process,
            also when it was tried again.
        """


@dataclass(frozen=True)
class _Home:
    """Where a run was started: a worker may be older than that, or far away.

    Attributes:
        process: its number.
        folder: the current one.
        sources: what registered the environments of others.
    """

    process: int
    folder: str
    sources: tuple[str, ...]

    @classmethod
    def here(cls) -> _Home:
        """This process'."""
        return cls(os.getpid(), os.getcwd(), sources())

    def call(self, function: Callable[..., T], *task: Any) -> T:
        """Call a function there."""
        if os.getpid() != self.process:
            keep_freed_memory()
        with suppress(FileNotFoundError):
            os.chdir(self.folder)
        import_sources(self.sources)
        return function(*task)


def _placed(place: int, home: _Home, function: Callable[..., T], task: Task) -> tuple[int, T]:
    return place, home.call(function, *task)


class Processes:
    """Processes of this machine.

    Args:
        jobs: how many; -1 = one per core. With 1 everything runs in this process, in the order of the tasks.
    """

    def __init__(self, jobs: int) -> None:
        if jobs == 0:
            raise ValueError("jobs is 0; give the number of worker processes, or -1 for one per core")
        self.jobs = jobs

    @property
    def workers(self) -> int:
        """See `Backend`."""
        return int(cpu_count()) if self.jobs < 0 else self.jobs

    def run(self, function: Callable[..., T], tasks: Sequence[Task]) -> Iterator[tuple[int, T | None]]:
        """See `Backend`. A task that ends its process takes the others down, so what is left runs one by one."""
        left = dict(enumerate(tasks))
        try:
            for place, result in self._results(self.jobs, function, dict(left)):
                del left[place]
                yield place, result
        except TerminatedWorkerError:
            for place, task in left.items():
                try:
                    yield from self._results(2, function, {place: task})
                except TerminatedWorkerError:
                    yield place, None

    @staticmethod
    def _results(jobs: int, function: Callable[..., T], tasks: Mapping[int, Task]) -> Iterator[tuple[int, T]]:
        # Workers keep the memory that they work with: joblib takes that for a leak, where psutil tells it, and puts a
        # new worker in the place of one that has nothing to do.
        warnings.filterwarnings("ignore", "A worker stopped while some jobs were given", UserWarning)
        # Threads inside a worker would fight the other workers for the cores.
        parallel = Parallel(n_jobs=jobs, return_as="generator_unordered", inner_max_num_threads=1)
        here = _Home.here()
        yield from parallel(delayed(_placed)(place, here, function, task) for place, task in tasks.items())


class RayWorkers:
    """Workers of a Ray cluster, which must have the same packages, and the same files at the same places.

    Args:
        ray: the package.
    """

    def __init__(self, ray: Any) -> None:
        self._ray = ray

    @property
    def workers(self) -> int:
        """See `Backend`."""
        return max(1, int(self._ray.cluster_resources().get("CPU", 1)))

    def run(self, function: Callable[..., T], tasks: Sequence[Task]) -> Iterator[tuple[int, T | None]]:
        """See `Backend`. A task whose worker dies is started again `RETRIES` times. Raises BackendError."""
        remote = self._ray.remote(max_retries=RETRIES)(_Home.call)
        shared: dict[int, Any] = {}
        running = {}
        for place, task in enumerate(tasks):
            for part in task:  # what several tasks share travels once
                if id(part) not in shared:
                    shared[id(part)] = self._ray.put(part)
            running[remote.remote(_Home.here(), function, *(shared[id(part)] for part in task))] = place
        while running:
            (done,), _ = self._ray.wait(list(running), num_returns=1)
            yield running.pop(done), self._result(done)

    def _result(self, done: Any) -> Any:
        errors = self._ray.exceptions
        try:
            return self._ray.get(done)
        except (errors.WorkerCrashedError, errors.OutOfMemoryError):
            return None
        except errors.RayTaskError:
            raise
        except errors.RayError as error:
            raise BackendError(f"Ray lost its workers: {error}") from error


@contextmanager
def _ray_workers(jobs: int, address: str | None) -> Iterator[RayWorkers]:
    os.environ.update({name: os.environ.get(name, value) for name, value in _RAY_ENVIRONMENT.items()})
    try:
        ray = importlib.import_module("ray")
    except ModuleNotFoundError as error:
        raise BackendError(f"{error}; install what --backend ray needs with: {install_command('ray')}") from error
    local = {"num_cpus": cpu_count() if jobs < 0 else jobs, "include_dashboard": False}
    try:
        ray.init(address=address or "local", log_to_driver=False, logging_level="ERROR", **({} if address else local))
    except (ConnectionError, ValueError, RuntimeError) as error:
        raise BackendError(f"there is no Ray cluster at {address or 'this machine'}: {error}") from error
    try:
        yield RayWorkers(ray)
    finally:
        ray.shutdown()


def backend_of(name: Name, jobs: int, address: str | None = None) -> AbstractContextManager[Backend]:
    """The backend of that name, to be used in a `with` statement.

    Args:
        name: "joblib", or "ray", which needs the extra "ray".
        jobs: number of workers; -1 = one per core. A cluster at `address` has its own.
        address: of a running Ray cluster, as ray.init takes it; None starts one on this machine.

    Raises:
        BackendError: Ray is not installed, or there is no cluster at that address.
    """
    return _ray_workers(jobs, address) if name == "ray" else nullcontext(Processes(jobs))
