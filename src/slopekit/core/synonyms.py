"""Synonyms of keys, options and parameters: one table for files, commands and Python."""

import re
from collections.abc import Iterable, Mapping

_ABBREVIATION = 3  # letters of a word that may be the beginning of the one that was meant
#: Words that are read as a key, the first of these that is known where the word stands.
SYNONYMS: Mapping[str, tuple[str, ...]] = {
    **dict.fromkeys(("cohesion", "coh", "cohesive_strength"), ("c",)),
    **dict.fromkeys(
        (
            "friction",
            "friction_angle",
            "angle_of_friction",
            "internal_friction_angle",
            "phi_deg",
            "fi",
        ),
        ("phi",),
    ),
    **dict.fromkeys(("tensile_strength", "tension_strength"), ("tension",)),
    **dict.fromkeys(("dilation_angle", "dilatancy", "dilatancy_angle"), ("dilation",)),
    **dict.fromkeys(("gamma", "unitweight", "unit_wt", "gamma_rock"), ("unit_weight",)),
    **dict.fromkeys(("gamma_w", "gamma_water"), ("water_unit_weight",)),
    **dict.fromkeys(("rho", "rock_density", "bulk_density"), ("density",)),
    **dict.fromkeys(
        ("kh", "k_h", "seismic_coefficient", "horizontal_seismic_coefficient"), ("k", "seismic")
    ),
    **dict.fromkeys(("dipdir", "dip_dir", "dipdirection", "dip_azimuth"), ("dip_direction",)),
    **dict.fromkeys(("youngs_modulus", "young_modulus", "elastic_modulus"), ("modulus",)),
    **dict.fromkeys(("poisson_ratio", "poissons_ratio"), ("poisson",)),
    **dict.fromkeys(("fs", "factor_of_safety", "safety_factor"), ("fos",)),
}
#: What is the tangent of a friction angle, and no angle.
TANGENTS = ("tan_phi", "friction_coefficient", "coefficient_of_friction", "friction_factor")
#: What is near to a key in letters, and something else: nothing is proposed for it.
_NOT_SYNONYMS = ("phi_b", "phi_basic", "basic_friction_angle", "ru", "r_u", "kv", "k_v", "strike")
#: Words that may mean more than one thing, or need another value: a key is proposed for them, none is taken.
_LIKELY: Mapping[str, tuple[str, ...]] = {
    **dict.fromkeys(("azimuth", "dd"), ("dip_direction", "trend")),
    "bearing": ("trend", "dip_direction"),
    **dict.fromkeys(("weight", "specific_weight"), ("unit_weight",)),
    **dict.fromkeys(
        ("factor", "fos", "fs", "sf", "safety", "factor_of_safety", "safety_factor", "min_fos"),
        ("fos", "accept_fos", "rules", "accept"),
    ),
    **dict.fromkeys(("slope", "slope_face", "face_dip", "bench_face"), ("face",)),
    **dict.fromkeys(("crest", "upper_slope", "top", "bench"), ("upper",)),
    **dict.fromkeys(("h", "slope_height", "bench_height"), ("height",)),
    **dict.fromkeys(
        ("joints", "planes", "j1", "dips", "discontinuities", "discontinuity"), ("dips", "joints")
    ),
    **dict.fromkeys(("material", "materials", "strengths"), ("strength",)),
    **dict.fromkeys(("pore_pressure", "water_pressure"), ("pressures", "water")),
    **dict.fromkeys(("earthquake", "quake", "pga"), ("seismic", "k")),
    **dict.fromkeys(("anchor", "anchors", "bolt", "rockbolts"), ("bolts", "bolt")),
    **dict.fromkeys(("force", "load", "loads", "external_force"), ("forces", "force")),
    **dict.fromkeys(("tension_crack", "tc"), ("crack",)),
    **dict.fromkeys(("e", "e_modulus", "young"), ("modulus",)),
    **dict.fromkeys(("nu",), ("poisson",)),
    **dict.fromkeys(("kn", "k_n"), ("normal", "normal_stiffness")),
    **dict.fromkeys(("ks", "k_s", "kt", "k_t"), ("shear", "shear_stiffness")),
    **dict.fromkeys(("std", "stdev", "sigma", "standard_deviation"), ("sd",)),
    **dict.fromkeys(("distribution", "type"), ("dist",)),
    **dict.fromkeys(("average", "mu"), ("mean",)),
    **dict.fromkeys(("gaussian", "gauss"), ("normal",)),
    **dict.fromkeys(("direction", "dir"), ("dip_direction", "toward", "trend")),
    **dict.fromkeys(("capacity", "tension_force"), ("force",)),
    **dict.fromkeys(("psi", "i_angle"), ("dilation",)),
    **dict.fromkeys(TANGENTS, ("phi",)),
    **dict.fromkeys(("friction", "friction_angle", "phi"), ("tan_phi",)),  # of partial factors
    **dict.fromkeys(("samples", "n_samples", "number", "runs"), ("n",)),
    **dict.fromkeys(("out", "output", "folder"), ("o",)),
    **dict.fromkeys(("orientation", "attitude"), ("plane",)),
}


def folded(word: str) -> str:
    """A word as the table has it: `Friction angle`, `--friction-angle` and `friction_angle` are one.

    >>> folded("--Friction-angle")
    'friction_angle'
    """
    return re.sub(r"[\s_-]+", "_", word.strip().lstrip("-")).lower()


def synonym(word: str, names: Iterable[str]) -> str | None:
    """The known word that another stands for; None for one that is known itself, or stands for none of them.

    >>> synonym("Friction angle", ["c", "phi"]), synonym("--kh", ["--seismic"]), synonym("azimuth", ["dip_direction"])
    ('phi', '--seismic', None)
    """
    return _table_match(word, names, SYNONYMS)


def nearest(word: str, names: Iterable[str], n: int = 1, cutoff: float = 0.6) -> list[str]:
    """The known words that were likely meant: what the word is in the trade, else those that are written nearly so.

    >>> nearest("cohesion", ["tension", "c"]), nearest("hieght", ["height"]), nearest("factor", ["accept_fos"])
    (['c'], ['height'], ['accept_fos'])
    """
    from difflib import get_close_matches  # what has no slip does not pay for it

    names = list(names)
    likely = _table_match(word, names, SYNONYMS) or _table_match(word, names, _LIKELY)
    if likely is not None:
        return [likely]
    by_fold = {folded(name): name for name in reversed(names)}
    if folded(word) in _NOT_SYNONYMS and folded(word) not in by_fold:
        return []
    longer = [name for name in by_fold if name.startswith(folded(word))]
    if len(longer) == 1 and len(word) >= _ABBREVIATION:
        return [by_fold[longer[0]]]
    return [by_fold[name] for name in get_close_matches(folded(word), by_fold, n=n, cutoff=cutoff)]


def is_likely(word: str, name: str) -> bool:
    """Whether a word is what the trade calls a known one: no slip of letters."""
    return (
        _table_match(word, [name], SYNONYMS) is not None
        or _table_match(word, [name], _LIKELY) is not None
    )


def _table_match(
    word: str, names: Iterable[str], table: Mapping[str, tuple[str, ...]]
) -> str | None:
    names = list(names)
    if word in names:
        return None
    meanings = table.get(folded(word), ())
    by_fold = {folded(name): name for name in reversed(names)} if meanings else {}
    return next((by_fold[name] for name in meanings if name in by_fold), None)
