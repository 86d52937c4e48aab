from collections.abc import Callable, Iterator, Mapping, Sequence
from os import PathLike
from typing import Any, final, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._table import Table

__all__ = [
    "SHAPE_CLASSES",
    "ArgumentError",
    "Batch",
    "Calibration",
    "CameraCalibration",
    "ConfigError",
    "DesignAnswer",
    "Distinction",
    "Figure",
    "GlideEstimate",
    "Layout",
    "PalpateError",
    "Pattern",
    "PressEstimate",
    "ReadingsError",
    "Record",
    "Report",
    "Results",
    "RollEstimate",
    "RunError",
    "Sensitivity",
    "Study",
    "Trace",
    "Tracked",
    "__version__",
    "calibrate",
    "calibrate_camera",
    "calibrate_frames",
    "design",
    "distinguish",
    "estimate_glide",
    "estimate_press",
    "estimate_roll",
    "explain",
    "pattern",
    "report",
    "schema",
    "sensitivity",
    "track",
]

__version__: str
SHAPE_CLASSES: tuple[str, ...]

_Floats = NDArray[np.float64]
_Pixels = NDArray[np.uint8]

class PalpateError(ValueError):
    argument: str | None
    index: tuple[int, ...]
    value: float | None

class ArgumentError(PalpateError): ...
class ReadingsError(PalpateError): ...

class ConfigError(PalpateError):
    path: str

class RunError(PalpateError): ...

class Record:
    def __new__(cls, fields: dict[str, Any], arrays: dict[str, Any] | None = None) -> Record: ...
    def __getattr__(self, name: str) -> Any: ...
    def __getitem__(self, name: str, /) -> Any: ...
    def __float__(self) -> float: ...
    def __eq__(self, other: object, /) -> bool: ...
    def to_dict(self, *, arrays: bool = False) -> dict[str, Any]: ...
    def _repr_html_(self) -> str: ...

class _Value(Record):
    value: float
    std: float | None
    interval95: _Floats | None
    unit: str

class _Measured(_Value):
    interval95: _Floats

class _Radius(Record):
    value: float | None
    std: float | None
    convex95: _Floats | None
    concave95: _Floats | None
    unit: str

@final
class RollEstimate(Record):
    method: str
    probes: int
    normal_curvature_u: _Value
    normal_curvature_v: _Value
    gaussian_curvature: _Value
    mean_curvature: _Value
    arc_length: _Value
    principal_curvature_min: _Value
    principal_curvature_max: _Value
    principal_direction_max_deg: float | None
    principal_direction_max_std_deg: float | None
    amplification_u: float | None
    amplification_v: float | None
    residual_rms: _Value
    single_direction: Record | None
    radius: _Radius
    std_from: str
    class_: str | None
    class_probabilities: Record | None
    thresholds: Record | None
    unresolved_probes: list[Record]
    p_value: float | None
    warnings: list[Record]
    covariance: _Floats

class _Run(Record):
    from_: float | str
    to: float | str

class _Result(Record):
    value: float | str
    statistic: float | None
    std_error: float | None
    failing: float
    main_failure: str | None

class _Column(Record):
    at: Record
    meets: list[_Run]
    misses: list[_Run]
    best: _Result | None
    failing_end: _Result | None
    narrowed: int
    ended: str

@final
class DesignAnswer(Record):
    study: str
    answer: str
    target: str
    max_failures: float
    grid: list[Record]
    path: str
    unit: str
    confidence: float
    sought: str | None
    best_that_meets: Record | None
    columns: list[_Column]
    meets: list[_Run]
    misses: list[_Run]
    best: _Result | None
    failing_end: _Result | None
    narrowed: int
    ended: str
    lines: list[str]
    table: Table
    runs: Table
    figure: Figure

class _Score(Record):
    claim: int
    study: str
    paper_says: str
    measured: str
    verdict: str
    why: str

@final
class Report(Record):
    scores: list[_Score]
    text: str
    html: str

class _Pair(Record):
    first: str
    second: str
    told_apart: float | None
    low95: float | None
    high95: float | None
    repeats: int | None

class _Object(Record):
    object: str
    failing: float
    main_failure: str | None

class _Group(Record):
    settings: str
    objects: list[_Object]
    pairs: list[_Pair]

@final
class Distinction(Record):
    study: str
    quantity: str
    confidence: float
    groups: list[_Group]
    answer: list[str]
    table: Table
    figure: Figure

class _FieldEffect(Record):
    field: str
    value: float
    values: list[float]
    rms_errors: list[float]
    effect: float
    effect_std: float
    failures: int

class _SkippedField(Record):
    field: str
    why: str

@final
class Sensitivity(Record):
    study: str
    quantity: str
    unit: str
    trials: int
    rms_error: float
    effects: list[_FieldEffect]
    skipped: list[_SkippedField]
    table: Table
    figure: Figure

class _Map(Record):
    position: _Floats
    normal: _Floats
    gaussian_curvature: _Floats
    gaussian_curvature_std: _Floats
    mean_curvature: _Floats
    mean_curvature_std: _Floats
    k_min: _Floats
    k_max: _Floats
    direction_of_min: _Floats
    direction_of_max: _Floats
    shape_index: _Floats
    class_index: NDArray[np.int64]
    region: NDArray[np.int64]
    class_probabilities: _Floats

@final
class GlideEstimate(Record):
    method: str
    contacts: int
    fingers: int
    with_normals: bool
    length_unit: str
    position: _Floats
    normal: _Floats
    gaussian_curvature: _Value
    mean_curvature: _Value
    radius: _Radius
    k_min: _Value
    k_max: _Value
    direction_of_min: _Floats
    direction_of_max: _Floats
    shape_index: float | None
    class_: str
    class_probabilities: Record | None
    sign_class: str
    thresholds: Record
    noise: Record | None
    status: str | None
    effective_unknowns: float
    grid: int
    regions: list[Record]
    p_value: float | None
    warnings: list[Record]
    covariance: _Floats
    map: _Map
    map_csv: str

@final
class PressEstimate(Record):
    method: str
    c: float | None
    markers: int
    with_tangential: bool
    length_unit: str
    relative_curvature: _Measured
    effective_radius: _Measured
    object_curvature: _Measured
    object_radius: _Radius
    regime: str
    verdict: str
    indentation: _Measured
    contact_radius: _Measured
    force: _Value | None
    peak_pressure: _Value | None
    contact: _Floats
    contact_std: _Floats
    baseline: _Measured | None
    gain: _Measured | None
    wrong_markers: list[Record]
    noise: Record
    r_squared: float
    contact_seen: bool
    warnings: list[Record]

@final
class Batch:
    def __new__(cls, estimates: list[tuple[Record | None, str]]) -> Batch: ...
    @property
    def errors(self) -> dict[int, str]: ...
    def __getattr__(self, name: str) -> Any: ...
    def __len__(self) -> int: ...
    def __getitem__(self, index: int, /) -> Any: ...
    def to_dict(self) -> dict[str, Any]: ...

@final
class Figure:
    def __new__(cls, name: str, title: str, svg: str) -> Figure: ...
    @property
    def name(self) -> str: ...
    @property
    def title(self) -> str: ...
    @property
    def svg(self) -> str: ...
    def _repr_svg_(self) -> str: ...

@final
class Calibration:
    def __new__(
        cls, toml: str, summary: list[str] | None = None, warnings: list[Record] | None = None
    ) -> Calibration: ...
    @property
    def summary(self) -> list[str]: ...
    @property
    def warnings(self) -> list[Record]: ...
    @property
    def length_unit(self) -> str: ...
    def to_toml(self) -> str: ...
    def to_dict(self) -> dict[str, Any]: ...

@final
class CameraCalibration:
    def __new__(cls, toml: str) -> CameraCalibration: ...
    @property
    def summary(self) -> str: ...
    @property
    def warnings(self) -> list[Record]: ...
    @property
    def length_unit(self) -> str: ...
    def to_toml(self) -> str: ...
    def to_dict(self) -> dict[str, Any]: ...

@final
class Tracked(Record):
    fates: Record
    warnings: list[Record]
    markers: Table
    overlay: _Pixels
    difference: _Pixels
    readings: Table | None
    field: Table | None
    estimate: PressEstimate | None

@final
class Pattern(Record):
    gores: int
    markers: int
    greatest_fold_strain: float
    rms_fold_strain: float
    svg: str
    dxf: str
    strain: Table
    strain_by_gores: Table

@final
class Layout:
    def __new__(
        cls,
        radius: float,
        layout: str | dict[str, Any] | None = None,
        *,
        marker_depth: float = 0.0,
        discs: dict[str, float] | None = None,
        length_unit: str = "mm",
    ) -> Layout: ...
    @staticmethod
    def of(study: Study) -> Layout: ...
    @property
    def positions(self) -> _Floats: ...
    def pattern(self) -> Pattern: ...
    def __len__(self) -> int: ...

@final
class Study:
    def __new__(cls, source: str | dict[str, Any] | PathLike[str], *, name: str | None = None) -> Study: ...
    @property
    def name(self) -> str: ...
    @property
    def title(self) -> str: ...
    @property
    def length_unit(self) -> str: ...
    @property
    def cell_count(self) -> int: ...
    @property
    def trials(self) -> int: ...
    @property
    def seed(self) -> int: ...
    @property
    def toml(self) -> str: ...
    @property
    def resolved(self) -> str: ...
    def to_dict(self) -> dict[str, Any]: ...
    def cell(self, number: int) -> dict[str, Any]: ...
    def with_(self, fields: dict[str, Any] | None = None, /, **more: Any) -> Study: ...
    def sweep(self, axes: dict[str, Any] | None = None, /, **more: Any) -> Study: ...
    def check(self, *, threads: int | None = None, progress: Callable[[int], Any] | None = None) -> Record: ...
    def plan(
        self, *, budget: float | None = None, target_error: float | None = None, threads: int | None = None
    ) -> Study: ...
    def run(
        self,
        *,
        trials: int | None = None,
        seed: int | None = None,
        threads: int | None = None,
        cells: Sequence[int] | None = None,
        trials_out: bool = False,
        progress: Callable[[int], Any] | None = None,
    ) -> Results: ...
    def trace(self, cell: int = 0, trial: int | None = None) -> Trace: ...
    def pattern(self) -> Pattern: ...

@final
class Results:
    @property
    def study(self) -> Study: ...
    @property
    def cells(self) -> Table: ...
    @property
    def failures(self) -> Table: ...
    @property
    def map(self) -> Table | None: ...
    @property
    def trials_out(self) -> Table | None: ...
    @property
    def warnings(self) -> list[Record]: ...
    @property
    def plots(self) -> list[str]: ...
    @property
    def figures(self) -> list[Figure]: ...
    @property
    def claims(self) -> Table: ...
    @staticmethod
    def read(folder: str | PathLike[str]) -> Results: ...
    def plot(self, name: str | None = None, **keys: Any) -> Figure: ...
    def trace(self, cell: int = 0, trial: int | None = None) -> Trace: ...
    def files(self) -> dict[str, str]: ...
    def _repr_html_(self) -> str: ...

@final
class Trace(Record):
    what: str
    contacts: Table
    readings: Table
    markers: Table | None
    rest: _Pixels | None
    pressed: _Pixels | None
    figures: list[Figure]

def schema() -> dict[str, Any]: ...
def estimate_roll(
    rotations: ArrayLike,
    shifts: ArrayLike,
    *,
    probe_radius: float | None = None,
    pitch: float | None = None,
    shift_std: float | None = None,
    rotation_std_rad: float | None = None,
    relative_rotation_std: float | None = None,
    pad_layout: str | None = None,
    start: ArrayLike | None = None,
    times: ArrayLike | None = None,
    method: str | None = None,
    length_unit: str | None = None,
    like: Study | None = None,
    cell: int = 0,
    threads: int | None = None,
) -> RollEstimate | Any: ...
def estimate_glide(
    points: ArrayLike,
    normals: ArrayLike | None = None,
    fingers: ArrayLike | None = None,
    *,
    # Settings of the estimator of a glide, by settings.py.
    method: str | None = None,
    criterion: str | None = None,
    gamma: float | None = None,
    intervals: int | None = None,
    normal_std_deg: float | None = None,
    position_fraction_of_ifd: float | None = None,
    position_std: float | None = None,
    first_degree: int | None = None,
    tangent_normals: str | None = None,
    passes: int | None = None,
    second_degree: int | None = None,
    second_smoothing: float | None = None,
    smoothing: float | None = None,
    tangent_step: float | None = None,
    weight: float | None = None,
    # Others.
    grid: int | None = None,
    at_contacts: bool = False,
    tip_radius: float | None = None,
    reports: str | None = None,
    outward: Sequence[float] | None = None,
    gaussian_threshold: float | None = None,
    mean_threshold: float | None = None,
    inter_finger_distance: float | None = None,
    length_unit: str | None = None,
    like: Study | None = None,
    cell: int = 0,
    threads: int | None = None,
) -> GlideEstimate | Any: ...
def estimate_press(
    positions: ArrayLike,
    displacements: ArrayLike,
    *,
    # Settings of the estimator of a press, by settings.py.
    method: str | None = None,
    baseline: str | None = None,
    gain_std: float | None = None,
    noise: str | None = None,
    poisson: float | None = None,
    thickness: float | None = None,
    c: float | None = None,
    window: float | None = None,
    shift_std: float | None = None,
    # Others.
    sensor_radius: float | None = None,
    depth: float | None = None,
    indentation: float | None = None,
    indentation_std: float | None = None,
    normal_std: float | None = None,
    tangential_std: float | None = None,
    radial_scale: float | None = None,
    young: float | None = None,
    length_unit: str | None = None,
    like: Study | None = None,
    cell: int = 0,
    threads: int | None = None,
) -> PressEstimate | Any: ...
def calibrate(
    *tables: Mapping[str, ArrayLike],
    source: str = "hue",
    per_marker: bool = False,
    length_unit: str | None = None,
) -> Calibration: ...
def calibrate_frames(
    rest: ArrayLike,
    pressed: Sequence[ArrayLike],
    *,
    normal: ArrayLike | None = None,
    tangential: ArrayLike | None = None,
    px_per_rad: float | None = None,
    source: str = "hue",
    per_marker: bool = False,
    length_unit: str | None = None,
    srgb: bool = False,
) -> Calibration: ...
def calibrate_camera(rest: ArrayLike, study: Study, *, cell: int = 0, srgb: bool = False) -> CameraCalibration: ...
def track(
    rest: ArrayLike,
    pressed: ArrayLike,
    *,
    calibration: Calibration | CameraCalibration | None = None,
    px_per_rad: float | None = None,
    grid: int = 30,
    filter: float = 0.0,
    srgb: bool = False,
    like: Study | None = None,
    cell: int = 0,
    **settings: Any,
) -> Tracked: ...
def pattern(sensor: Study | Layout) -> str: ...
def design(
    study: Study,
    target: str,
    vary: str | list[str] | dict[str, Any],
    *,
    maximise: str | None = None,
    minimise: str | None = None,
    set: dict[str, Any] | None = None,
    max_failures: float = 0.05,
    gap: float = 0.05,
    most_trials: int = 4_194_304,
    budget: float | None = ...,
    seed: int | None = None,
    threads: int | None = None,
    progress: Callable[[int], Any] | None = None,
) -> DesignAnswer: ...
def distinguish(
    study: Study,
    *,
    vary: dict[str, list[Any]] | None = None,
    set: dict[str, Any] | None = None,
    quantity: str | None = None,
    confidence: float = 0.95,
    trials: int | None = None,
    seed: int | None = None,
    threads: int | None = None,
    progress: Callable[[int], Any] | None = None,
) -> Distinction: ...
def sensitivity(
    study: Study,
    *,
    set: dict[str, Any] | None = None,
    quantity: str | None = None,
    step: float = 0.05,
    trials: int = 1000,
    seed: int | None = None,
    threads: int | None = None,
    progress: Callable[[int], Any] | None = None,
) -> Sensitivity: ...
def report(*studies: Results | str | PathLike[str]) -> Report: ...
@overload
def explain(word: str) -> str: ...
@overload
def explain(word: None = None) -> dict[str, dict[str, str]]: ...
