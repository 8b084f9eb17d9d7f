"""A real browser: where it is, how it is started, and a page in it in the words of the tests."""

import re
import shutil
import time
from importlib.resources import files as resources

import numpy as np
import pytest

CHROMIUM, DRIVER = shutil.which("chromium"), shutil.which("chromedriver")
needs = pytest.mark.skipif(
    not (CHROMIUM and DRIVER), reason="no chromium: apt-get install chromium chromium-driver"
)


def browser_needed(test):
    """A browser takes ten seconds, wherever it is."""
    return pytest.mark.slow(needs(test))


FLAGS = (
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--window-size=1280,900",
)


def start(downloads, profile):
    """A browser without a window that leaves downloads in a folder."""
    webdriver = pytest.importorskip("selenium.webdriver")
    options = webdriver.ChromeOptions()
    options.binary_location = CHROMIUM
    for flag in (*FLAGS, f"--user-data-dir={profile}"):
        options.add_argument(flag)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    options.add_experimental_option("prefs", {"download.default_directory": str(downloads)})
    return webdriver.Chrome(options=options, service=webdriver.ChromeService(DRIVER))


class Page:
    """A page in the browser, in the words of the tests."""

    def __init__(self, driver, path):
        self.driver = driver
        self.errors()  # those of the page before, which other tests may have left, are not this one's
        driver.get(path.as_uri())

    def __getitem__(self, selector):
        for _ in range(40):  # what opens on demand is filled a moment later
            if found := self.all(selector):
                return found[0]
            time.sleep(0.05)
        raise LookupError(f"nothing is {selector}")

    def all(self, selector):
        return self.driver.find_elements("css selector", selector)

    def js(self, code):
        return self.driver.execute_script(f"return {code}")

    def text(self, selector):
        return self[selector].text

    def counts(self):
        """How many designs are within the limits, and of how many."""
        return tuple(map(int, re.findall(r"\d+", self.text("#count"))))

    def limits(self, name):
        """The limits of a value, as its two fields show them."""
        fields = [self[f'input[aria-label^="{end} {name}"]'] for end in ("smallest", "largest")]
        ends = [f.get_property("value") for f in fields]
        return tuple(float(e) if e else s * np.inf for e, s in zip(ends, (-1, 1), strict=True))

    def drag(self, selector, start, end):
        """Drag inside an element, from and to fractions of its width and height."""
        actions = self._pointer(selector, start).click_and_hold()
        self._to(actions, selector, end).release().perform()

    def _pointer(self, selector, place):
        from selenium.webdriver.common.action_chains import ActionChains

        self.driver.execute_script("arguments[0].scrollIntoView({block: 'center'})", self[selector])
        return self._to(ActionChains(self.driver, duration=30), selector, place)

    def _to(self, actions, selector, place):
        element = self[selector]
        x, y = (
            round((part - 0.5) * element.size[side])
            for part, side in zip(place, ("width", "height"), strict=True)
        )
        return actions.move_to_element_with_offset(element, x, y)

    def settled(self):
        """Wait until all of the page shows what is drawn."""
        for _ in range(100):
            if self.text("#walk-title") == "The walk: drawn here" and self.js("walked.has(DRAWN)"):
                time.sleep(0.2)
                return
            time.sleep(0.05)
        raise AssertionError("the walk does not follow")

    def judged(self):
        """What axe-core finds, with everything open."""
        axe = (resources("axe_playwright_python") / "axe.min.js").read_text(encoding="utf-8")
        self.driver.execute_script("document.querySelectorAll('details').forEach((d) => { d.open = true; })")
        self.driver.execute_script(axe)
        self.driver.set_script_timeout(200)
        found = self.driver.execute_async_script(
            "const done = arguments[0]; axe.run({ resultTypes: ['violations'] }).then(done)"
        )
        return [(v["id"], [node["html"] for node in v["nodes"]]) for v in found["violations"]]

    def errors(self):
        return [entry for entry in self.driver.get_log("browser") if entry["level"] == "SEVERE"]


def arrived(folder, ending):
    """The text of the only file with an ending, once the browser has written it."""
    for _ in range(100):
        found = [p for p in folder.glob(f"*.{ending}") if p.stat().st_size]
        if found and not list(folder.glob("*.crdownload")):
            text = found[0].read_text(encoding="utf-8")
            found[0].unlink()
            return text
        time.sleep(0.05)
    raise AssertionError(f"no .{ending} file arrived")
