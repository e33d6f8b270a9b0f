"""Sphinx extension: words of readers that the search and the index of the site find.

A word of `WORDS` leads to its place first, whether the page has the word or not.
"""

from docutils import nodes
from sphinx import addnodes
from sphinx.transforms import SphinxTransform
from sphinx.util import logging

WORDS = {  # page#section: what a reader may type
    "course/index": ("course", "lesson", "tutorial"),
    "course/01_fly_an_fmu": ("notebook", "Jupyter", "example"),
    "contributors/developing": ("contributing", "bug", "issue"),
    "contributors/developing#release": ("publish", "wheel"),
    "measurements/benchmarks": ("speed", "performance"),
    "measurements/measured_flights": ("experiment",),
    "measurements/stability#extreme-scenarios-with-a-known-answer": ("snap load", "shock load"),
    "measurements/validation": ("verification", "accuracy"),
    "models/scope": ("scope", "limitations", "bending", "torsion", "water", "sea water", "model exchange", "seabed"),
    "models/theory#elastic-catenary": ("catenary", "sag"),
    "models/theory#one-segment": ("lumped mass", "spring-damper"),
    "reference/api": ("Python",),
    "reference/api#turbulence": ("turbulence", "gusts"),
    "reference/changes": ("semantic versioning", "compatibility", "deprecation", "promises", "new in this version"),
    "reference/commands": ("command line", "terminal", "options"),
    "reference/fmi#derivatives": ("directional derivatives", "derivatives", "Jacobian"),
    "reference/fmi#saved-states": ("saved states", "rollback", "serialization"),
    "reference/variables": ("outputs", "inputs", "value references"),
    "reference/variables#parameters": ("elastic modulus", "Young's modulus", "stiffness", "material", "EA"),
    "reference/variables#outputs": ("tension", "force"),
    "use/coupling": ("co-simulation", "kite model", "communication step"),
    "use/coupling#a-policy-that-steers-gymnasium": ("reinforcement learning",),
    "use/cranes_and_drones": ("crane", "hoist", "drone", "UAV", "cable"),
    "use/comparison": ("alternatives", "OrcaFlex"),
    "use/example_fmus": ("pumping cycle", "controller"),
    "use/faq": ("questions", "FAQ"),
    "use/gallery": ("pictures", "examples"),
    "use/ground": ("friction", "landing"),
    "use/how_much_tether": ("fidelity", "tolerance", "number of segments", "time step", "step size"),
    "use/scene_files": ("scene", "TOML"),
    "use/importing": ("host", "native", "co-simulation tool"),
    "use/importing#dymola-not-tested": ("Dymola",),
    "use/importing#fmpy-tested": ("FMPy",),
    "use/importing#openmodelica-not-tested": ("OpenModelica", "OMEdit"),
    "use/importing#simulink-not-tested": ("MATLAB", "Simulink"),
    "use/in_the_browser": ("browser", "WebAssembly"),
    "use/interface": ("units", "signs", "frame", "coordinate system", "SI units", "interface"),
    "use/interface#breaking-and-letting-go": ("breaking", "breaking load", "breaking strength", "rupture", "weak link"),
    "use/interface#the-winch": ("winch", "drum", "reel in", "reel out", "reeling", "winch power"),
    "use/real_time": ("hardware in the loop", "HIL"),
    "use/start": ("install", "installation", "download", "clone", "Windows"),
    "use/start#how-to-cite": ("citation", "cite", "BibTeX"),
    "use/start#licence-and-support": ("license", "licence", "MIT", "support", "help", "contact"),
    "use/sweeps": ("parameter study", "batch"),
    "use/systems": ("bridle", "MoorDyn", "network", "systems of tethers"),
    "use/systems#a-winch-that-holds-several-lines": ("steering tapes", "several lines"),
    "use/systems#lines-over-sheaves": ("sheave", "pulley", "hook block", "reeving", "fairlead", "block and tackle"),
    "use/troubleshooting": ("error", "error message", "warning", "message"),
    "use/tutorial": ("Tethers.jl lessons", "mass on a spring"),
    "use/your_rope": ("rope", "data sheet", "Dyneema", "steel wire", "rope data", "damping"),
    "use/your_log": ("replay", "flight log", "CSV"),
}
PLACES = {place: place.partition("#")[::2] for place in WORDS}  # page#section -> (page, section)


class Entries(SphinxTransform):
    """Add the words to a page as entries of the index."""

    default_priority = 840  # before Sphinx reads the entries

    def apply(self, **_):
        """Do so on one page."""
        page = self.env.current_document.docname
        for place, (where, section) in PLACES.items():
            if where == page:
                target = section or next(self.document.findall(nodes.section))["ids"][0]
                if target not in self.document.ids:
                    logging.getLogger(__name__).warning("words_of_search: %s has no section %s", page, target)
                entries = [("single", word, target, "main", None) for word in WORDS[place]]
                self.document.insert(0, addnodes.index(entries=entries, inline=False))


def setup(app):
    """Connect them."""
    app.add_transform(Entries)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
