"""The site in Chromium, at the widths of a phone and of a desk: nothing from other hosts, formulas, menu, tables, figures.

Needs the extra `docs`, and Chromium with its driver (Debian's packages `chromium` and `chromium-driver`).
"""

import html
import json
import re
import subprocess
import sys
import zlib
from pathlib import Path
from types import SimpleNamespace
from urllib.parse import quote, unquote
from urllib.request import urlopen

import numpy as np
import pytest

import chromium
from make_commands import parser_of
from tetherfmu.console.subcommands import SUBCOMMANDS
from tetherfmu.runtime.variants import EVERY_VARIANT
from tetherfmu.wiring.variables import variables

ROOT = Path(__file__).resolve().parents[2]
PHONE, NARROW, DESK = chromium.PHONE["width"], 1008, 1400  # widths of the window [px]
TEXTS = [path.relative_to(ROOT / "docs") for path in (ROOT / "docs").rglob("*.md")]
PAGES = sorted(path.with_suffix(".html").as_posix() for path in TEXTS if path.parts[0] != "publishing")  # no pages
pytestmark = chromium.needed


def write_flight(file):
    """A page of a flight that nobody flew: a straight tether to a kite on a circle, with forces at both ends."""
    from shared.flight_page import write_page

    seconds = np.linspace(0.0, 60.0, 3001)
    kite = 300.0 + 100.0 * np.stack([0.0 * seconds, np.cos(seconds), np.sin(seconds)], axis=-1)
    shape = np.linspace(0.0, 1.0, 6)[:, None] * kite[:, None]
    flight = SimpleNamespace(time=seconds, shape=shape, kite_force=-kite, ground_force=kite)
    write_page({"TetherDynamic": flight}, file, kite, title="Tether of a kite that flies a circle")


@pytest.fixture(scope="module")
def manual(tmp_path_factory):
    """Folder with the site, beside a page of a flight."""
    for needed in ("sphinx", "myst_parser", "plotly"):
        pytest.importorskip(needed, reason="needs the extras docs and html")
    folder = tmp_path_factory.mktemp("site")
    build = [sys.executable, "-m", "sphinx", "-W", "--keep-going", "-q", "-j", "2", "-b", "html", "-d", folder / "read"]
    done = subprocess.run([*build, ROOT / "docs", folder / "manual"], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    write_flight(folder / "flight.html")
    return folder / "manual"


@pytest.fixture(scope="module")
def site(manual):
    """Address of its folder, served on this machine."""
    with chromium.served(manual.parent) as address:
        yield address


@pytest.fixture(scope="module")
def chromium_of_module(tmp_path_factory):
    """Chromium in the dark theme."""
    with chromium.started(DESK, tmp_path_factory.mktemp("chromium")) as driver:
        yield driver


@pytest.mark.parametrize("page", PAGES)
def test_a_page_is_rendered_as_it_is_written(site, page):
    """All headings are headings, no fence of a block is left, and an option has two hyphens, as one types it."""
    with urlopen(f"{site}/manual/{quote(page)}") as answer:
        rendered = answer.read().decode("utf-8")
    main = rendered.partition("<article")[2].partition("</article>")[0]
    text = html.unescape(re.sub(r"<[^>]+>", "", main))
    assert ":::" not in text
    assert not re.search(r"(?<!\w)[\u2013\u2014][a-z]", text)  # dashes
    path = (ROOT / "docs" / page).with_suffix(".md")
    source = path.read_text(encoding="utf-8")
    include = r'^```\{include\} (\S+)(?:\n:start-after: "(.+)"\n:end-before: "(.+)")?$'
    for other, first, last in re.findall(include, source, re.MULTILINE):
        text = (path.parent / other).read_text(encoding="utf-8")
        source += text.partition(first)[2].partition(last)[0] if first else text
    prose = re.sub(r"^(```|~~~).*?^\1$", "", source, flags=re.MULTILINE | re.DOTALL)
    written = len(re.findall(r"^#{1,6} ", prose, re.MULTILINE))
    assert len(re.findall(r"<h[1-6]\b", main)) >= written > 0


@pytest.fixture(params=[PHONE, DESK], ids=["phone", "desk"])
def browser(request, chromium_of_module):
    """It with a window of one of the widths."""
    chromium.show_in(chromium_of_module, request.param)
    return chromium_of_module


def opened(browser, address):
    """Open a page; waits until MathJax, if there is any, is done."""
    browser.get(address)
    browser.execute_async_script("(window.MathJax?.startup?.promise ?? Promise.resolve()).then(arguments[0])")


def is_phone(browser):
    return browser.execute_script("return innerWidth") < 1000


MENU = (  # number of pages in the part of the menu that is seen, and whether the open one is
    "const menu = document.querySelector('.sidebar-scroll'), box = menu.getBoundingClientRect();"
    "const inside = each => { const {top, bottom, height} = each.getBoundingClientRect();"
    "  return height > 0 && top >= box.top && bottom <= box.bottom; };"
    "const here = menu.querySelector('.current-page > a');"
    "return [[...menu.querySelectorAll('.sidebar-tree a')].filter(inside).length, here === null || inside(here)]"
)


def the_sidebar_shows_it(browser, page):
    """The sidebar shows the open page, that of the first page some twenty of them."""
    chromium.wait_until(browser, f"(() => {{{MENU}}})()[1]")  # until fonts and the script that scrolls are there
    assert page != "index.html" or 18 <= browser.execute_script(MENU)[0] <= 25


@pytest.mark.parametrize("page", [*(f"manual/{page}" for page in PAGES), "flight.html"])
def test_pages_need_no_other_host_and_fit_the_window(site, chromium_of_module, page):
    """Loaded by a phone, whose window then becomes that of a desk."""
    browser = chromium_of_module
    chromium.show_in(browser, PHONE)
    browser.get_log("performance")
    opened(browser, f"{site}/{page}")
    if page != "flight.html":
        the_sidebar_shows_it(browser, page.removeprefix("manual/"))
    for width in (PHONE, DESK):
        chromium.show_in(browser, width)
        wide, viewport, unshown, wrong, title = browser.execute_script(
            "const count = what => document.querySelectorAll(what).length;"
            "return [document.documentElement.scrollWidth, innerWidth, count('.math:not(:has(mjx-container svg))'),"
            "        count('[data-mml-node=merror]'), document.title]"
        )
        assert viewport == width  # not the 980 px that a phone gives a page that says nothing of its width
        assert wide <= viewport
        assert (unshown, wrong) == (0, 0)  # formulas
        assert title
    asked = [each["request"]["url"] for each in chromium.messages(browser, "Network.requestWillBeSent")]
    assert f"{site}/{page}" in asked
    assert [url for url in asked if not url.startswith((f"{site}/", "data:", "blob:"))] == []


def test_links_of_all_rendered_pages_lead_somewhere(manual):
    """Also those between pages and sources, which no page of ours has: to files, and to places in them."""
    texts = {path: path.read_text(encoding="utf-8") for path in manual.rglob("*.html")}
    places = {path: set(re.findall(r'\bid="([^"]+)"', text)) for path, text in texts.items()}
    dead = []
    for path, text in texts.items():
        for link in set(re.findall(r'<a\b[^>]*\bhref="([^":]+)"', text)):
            target, _, place = unquote(html.unescape(link)).partition("#")
            file = (path.parent / target).resolve() if target else path
            if not file.exists() or (place and file in places and place not in places[file]):
                dead.append((path.relative_to(manual).as_posix(), link))
    assert len(texts) > 2 * len(PAGES)
    assert dead == []


def test_the_manual_has_formulas(site, browser):
    opened(browser, f"{site}/manual/models/theory.html")
    tall = browser.execute_script(
        "return [...document.querySelectorAll('.math svg')].map(each => each.getBoundingClientRect().height)"
    )
    assert len(tall) > 100
    assert min(tall) > 2.0  # px


SEARCHED = {  # what a reader types: where it leads
    "initial_length": "reference/variables.html#initial_length",
    "kite_force": "reference/variables.html#kite_force",
    "winch_force": "reference/variables.html#winch_force",
    "segments": "reference/variables.html#segments",
    "max_tension": "reference/variables.html#max_tension",
    "kite_position[1]": "reference/variables.html#kite_position",
    "portion_length": "reference/systems.html#LINE.portion_length",
    "--native": "reference/commands.html#build--native",
    "tetherfmu replay": "reference/commands.html#replay",
    "bibtex": "use/start.html#how-to-cite",
    "citation": "use/start.html#how-to-cite",
    "license": "use/start.html#licence-and-support",
    "pulley": "use/systems.html#lines-over-sheaves",
    "winch power": "use/interface.html#the-winch",
    "Simulink": "use/importing.html#simulink-not-tested",
    "units": "use/interface.html#signals-and-signs",
    "winch": "use/interface.html#the-winch",
    "install": "use/start.html#start-here",
    "reel in": "use/interface.html#the-winch",
    "notebook": "course/01_fly_an_fmu.html#fly-an-fmu",
    "elastic modulus": "reference/variables.html#parameters",
    "turbulence": "reference/api.html#turbulence",
    "breaking": "use/interface.html#breaking-and-letting-go",
    "TetherDynamic": "reference/api.html#tetherfmu.TetherDynamic",
    "drag coefficient": "reference/variables.html#drag_coefficient",
    "wind profile": "reference/variables.html#wind_profile",
    "tension": "reference/variables.html#outputs",
    "damping": "use/your_rope.html#your-rope",
    "time step": "use/how_much_tether.html#which-fmu-for-me",
    "error message": "use/troubleshooting.html#troubleshooting",
    "snap load": "measurements/stability.html#extreme-scenarios-with-a-known-answer",
}


@pytest.mark.parametrize("word", SEARCHED)
def test_search_leads_to_the_place(site, chromium_of_module, word):
    browser = chromium_of_module
    chromium.show_in(browser, DESK)
    opened(browser, f"{site}/manual/search.html?q={quote(word)}")
    chromium.wait_until(browser, "document.querySelector('ul.search li a')")
    found = browser.execute_script("return [...document.querySelectorAll('ul.search li a')].map(each => each.href)")
    assert re.sub(r"\?[^#]*", "", found[0]).endswith(f"/{SEARCHED[word]}")  # without the words that the page will highlight


def test_search_has_a_row_for_each_variable_and_option(manual):
    """Of all tethers and commands; the anchors are on the pages."""
    inventory = zlib.decompress((manual / "objects.inv").read_bytes().split(b"zlib.\n")[1]).decode("utf-8")
    rows = re.findall(r"^(.+) row:[^\n]*? 1 (\S+?)#(\S+) ", inventory, re.MULTILINE)
    listed = {name.partition("[")[0] for name, page, _ in rows if page == "reference/variables.html"}
    declared = {each.name for variant in EVERY_VARIANT for each in variables(variant, 21)}
    assert listed >= {name.partition("[")[0] for name in declared}
    options = {name for name, page, _ in rows if page == "reference/commands.html"}
    for command in SUBCOMMANDS:
        written = {option for action in parser_of(command)._actions for option in action.option_strings}
        assert options >= {f"tetherfmu {command}", *(f"tetherfmu {command} {each}" for each in written - {"-h", "--help"})}
    texts = {page: (manual / page).read_text(encoding="utf-8") for _, page, _ in rows}
    assert [row for row in rows if f'id="{row[2].replace("$", row[0])}"' not in texts[row[1]]] == []


@pytest.mark.parametrize("width", [NARROW, DESK])
def test_the_sidebar_shows_some_twenty_pages_and_the_open_one(site, chromium_of_module, width):
    """On a phone, too: see above."""
    browser = chromium_of_module
    chromium.show_in(browser, width)
    with chromium.without(browser, "*tex-svg-full.js*", "*/_images/*"):  # formulas and pictures take most of the time
        for page in ("index.html", *PAGES):
            opened(browser, f"{site}/manual/{page}")
            the_sidebar_shows_it(browser, page)


def test_the_menu_opens(site, browser):
    opened(browser, f"{site}/manual/index.html")
    edges = "const box = document.querySelector('.sidebar-drawer').getBoundingClientRect(); return [box.left, box.right]"
    if is_phone(browser):
        assert browser.execute_script(edges)[1] <= 0.0  # wholly outside of the window
        browser.find_element("css selector", ".nav-overlay-icon").click()
        chromium.wait_until(browser, "document.querySelector('.sidebar-drawer').getBoundingClientRect().left >= 0.0")
    left, right = browser.execute_script(edges)
    assert 0.0 <= left < right <= PHONE
    link = browser.find_element("css selector", ".sidebar-tree a[href='course/index.html']")
    browser.execute_script("arguments[0].scrollIntoView({block: 'center', behavior: 'instant'})", link)
    link.click()
    assert browser.title.startswith("Course")


@pytest.mark.parametrize("width", [PHONE, NARROW, DESK])
def test_the_meaning_of_a_variable_is_not_cut(site, chromium_of_module, width):
    browser = chromium_of_module
    chromium.show_in(browser, width)
    opened(browser, f"{site}/manual/reference/variables.html")
    cut = (
        "return [...document.querySelectorAll('table.variables')].map("
        "table => [table.parentElement.scrollWidth, table.parentElement.clientWidth])"
    )
    tables = browser.execute_script(cut)
    assert len(tables) == 6
    assert all(needed <= there for needed, there in tables)


def test_the_filter_leaves_the_variables_with_its_words(site, browser):
    opened(browser, f"{site}/manual/reference/variables.html")
    browser.find_element("css selector", "p.filter input").send_keys("drum friction")
    shown = browser.execute_script(
        "return [...document.querySelectorAll('table.variables tbody tr')].filter(row => row.offsetHeight > 0)"
        ".map(row => row.innerText)"
    )
    assert {re.match(r"\w+", row)[0] for row in shown} == {"winch_damping", "winch_friction", "winch_mass"}


def test_figures_are_links_and_follow_the_theme(site, browser):
    """Each SVG file has rules for a dark theme; nothing is inverted, least of all a picture or a colour map."""
    opened(browser, f"{site}/manual/use/how_much_tether.html")
    figures = browser.execute_script(
        "return [...document.querySelectorAll('article img')].map(figure => [figure.src, figure.parentElement.href,"
        "        figure.naturalWidth, getComputedStyle(figure).filter, getComputedStyle(figure).colorScheme])"
    )
    assert len(figures) >= 2
    for source, link, width, filtered, scheme in figures:
        assert link == source
        assert width > 0
        assert (filtered, scheme) == ("none", "dark")
        if source.endswith(".svg"):
            with urlopen(source) as file:
                assert b"prefers-color-scheme: dark" in file.read()
    browser.execute_script("document.body.dataset.theme = 'light'")
    assert browser.execute_script("return getComputedStyle(document.querySelector('article img')).colorScheme") == "light"


@pytest.mark.parametrize(("page", "figure"), [("how_much_tether", "decision"), ("interface", "signs")])
def test_letters_of_a_figure_can_be_read(site, browser, page, figure):
    """They are 11 points high."""
    opened(browser, f"{site}/manual/use/{page}.html")
    scale = browser.execute_script(
        f"const shown = document.querySelector(\"img[src$='{figure}.svg']\"); return shown.clientWidth / shown.naturalWidth"
    )
    assert 11.0 * 96.0 / 72.0 * scale > 10.0  # px


@pytest.mark.parametrize("page", [page for page in PAGES if re.match(r"course/\d", page)])
def test_a_lesson_shows_its_results_and_is_a_notebook(site, chromium_of_module, page):
    """What it prints, a picture, and an answer that is hidden; the notebook has the same code."""
    browser = chromium_of_module
    opened(browser, f"{site}/manual/{page}")
    code, pictures, hidden, link = browser.execute_script(
        "return [[...document.querySelectorAll('div.highlight-python pre')].map(each => each.textContent.trim()),"
        "        document.querySelectorAll('article img[src*=\"_images/\"]').length,"
        "        document.querySelectorAll('details:not([open]) div.highlight-text').length,"
        "        document.querySelector('p.notebook a').href]"
    )
    assert len(code) == 2
    assert pictures >= 1
    assert hidden == 1
    with urlopen(link) as file:
        cells = [cell for cell in json.load(file)["cells"] if cell["cell_type"] == "code"]
    assert [cell["source"] for cell in cells] == code


def test_page_of_a_flight(site, browser):
    opened(browser, f"{site}/flight.html")
    assert browser.title == "Tether of a kite that flies a circle"
    points, width, height, buttons = browser.execute_script(
        "const plot = document.querySelector('.js-plotly-plot');"
        "const path = plot._fullData.find(each => each.name == 'path of the kite');"
        "return [path.x.length, plot.clientWidth, plot.clientHeight,"
        "        [...document.querySelectorAll('.modebar-btn')].map(each => each.dataset.title)]"
    )
    assert points == 3001  # as flown, not only the moments of the slider
    assert (width, height > 400) == (browser.execute_script("return innerWidth"), True)
    assert buttons
    assert not any("hare" in button for button in buttons)  # none sends the flight to another host
    assert chromium.errors(browser) == []
