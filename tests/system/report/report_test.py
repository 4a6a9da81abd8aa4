"""report.html in headless Chromium: does the page do what it says?

    report_test.py PENUMBRA SCENE.pbrt
"""
import csv
import io
import json
import math
import pathlib
import re
import sys
import tempfile
import time
import unittest
import xml.etree.ElementTree as ET

import browser
import runs

PROGRAM, SCENE = sys.argv[1:3]
SVG = "{http://www.w3.org/2000/svg}"


def setUpModule():
    global FOLDER, RUN, ALONE, TRANSIENT, LARGE
    FOLDER = tempfile.TemporaryDirectory(prefix="penumbra_report_")
    RUN = runs.with_reference(PROGRAM, SCENE, pathlib.Path(FOLDER.name))
    ALONE = runs.without_reference(PROGRAM, SCENE, pathlib.Path(FOLDER.name))
    TRANSIENT = runs.transient(PROGRAM, SCENE, pathlib.Path(FOLDER.name))
    LARGE = runs.large(PROGRAM, SCENE, pathlib.Path(FOLDER.name))


def tearDownModule():
    FOLDER.cleanup()


class Page(unittest.TestCase):
    """One window per class, opened anew for each test."""
    run_folder = staticmethod(lambda: RUN)
    width, dark = 1280, False

    @classmethod
    def setUpClass(cls):
        cls.browser = browser.Browser(cls.width, 900, cls.dark)
        cls.addClassCleanup(cls.browser.driver.quit)

    def setUp(self):
        self.browser.open((self.run_folder() / "report.html").as_uri())

    def tearDown(self):
        self.assertEqual(self.browser.complaints(), [])

    def js(self, script, *arguments):
        return self.browser.run(script, *arguments)

    def click(self, css):
        self.js("document.querySelector(arguments[0]).click()", css)

    def slide(self, css, value):
        self.js("const i = document.querySelector(arguments[0]); i.value = arguments[1]; i.dispatchEvent(new Event('input'))", css, value)

    def pixels(self, i):
        """A number for what view i shows: another picture, another number."""
        return hash(self.js("return document.querySelectorAll('.view canvas')[arguments[0]].toDataURL()", i))


class WithReference(Page):
    def test_stands_alone(self):
        self.assertEqual(self.js("return performance.getEntriesByType('resource').map((e) => e.name)"), [])

    def test_shows_the_figures_of_run_json(self):
        run = json.loads((RUN / "run.json").read_text())
        text = self.browser.text("#table")
        for mix in run["mixes"]:
            self.assertIn(mix["mix"], text)
            self.assertIn(self.js("return significant(arguments[0])", mix["relmse"]), text)
        points = sum(len({p["passes"] for p in m["timeline"] if p["passes"] > 0}) for m in run["mixes"])
        self.assertEqual(self.js("return document.querySelectorAll('#chart .point').length"), points)
        self.assertEqual(self.js("return document.querySelectorAll('#chart .band').length"), len(run["mixes"]))

    def test_the_chart_tells_its_values(self):
        self.js("document.querySelector('#chart .point').dispatchEvent(new MouseEvent('mousemove', {clientX: 200, clientY: 200}))")
        self.assertIn("95 % interval", self.browser.text(".tip"))

    def test_every_number_has_a_meaning(self):
        bare = self.js("return [...document.querySelectorAll('td:not(:first-child), header dd, .facts dd')]"
                       ".filter((n) => n.textContent !== '–' && !n.dataset.meaning).map((n) => n.textContent)")
        self.assertEqual(bare, [])
        from selenium.webdriver.common.action_chains import ActionChains

        ActionChains(self.browser.driver).move_to_element(self.browser.find("#table td:nth-child(2)")).perform()
        self.assertEqual(self.js("return getComputedStyle(tip).visibility"), "visible")
        self.assertIn("Camera samples", self.browser.text(".tip"))

    def test_the_time_slider_moves_its_readout(self):
        before, line = self.browser.text("#readout-table"), self.js("return document.getElementById('chosen-time').getAttribute('x1')")
        self.slide("#time", 90)
        self.assertNotEqual(self.browser.text("#readout-table"), before)
        self.assertNotEqual(self.js("return document.getElementById('chosen-time').getAttribute('x1')"), line)
        self.slide("#time", 400)
        self.assertGreater(self.js("return document.querySelectorAll('#readout-table .extrapolated').length"), 0)

    def test_the_error_slider_moves_its_readout(self):
        before = self.browser.text("#readout-table")
        self.slide("#error", 250)
        self.assertNotEqual(self.browser.text("#readout-table"), before)
        self.assertIn(self.browser.text("#error-value"), self.browser.text("#readout-table"))

    def test_curves_are_read_as_documented(self):
        curve = "[{t: 1, e: 1, lo: 0.5, hi: 2}, {t: 4, e: 0.25, lo: 0.125, hi: 0.5}]"
        at = lambda t, floor=0: self.js(f"return errorAt({curve}, {t}, {floor})")
        to = lambda e, floor=0: self.js(f"return timeTo({curve}, {e}, {floor})")
        self.assertAlmostEqual(at(2)["value"], 0.5)
        self.assertAlmostEqual(at(2)["lo"], 0.25)
        self.assertEqual(at(0.5)["how"], "none")
        self.assertAlmostEqual(at(8)["value"], 0.125)
        self.assertEqual(at(8)["how"], "extrapolated")
        self.assertAlmostEqual(at(8, 0.05)["value"], 0.05 + 0.1)
        self.assertAlmostEqual(to(0.5)["value"], 2)
        self.assertAlmostEqual(to(0.5)["lo"], 1)
        self.assertAlmostEqual(to(0.5)["hi"], 4)
        self.assertAlmostEqual(to(0.125)["value"], 8)
        self.assertEqual(to(0.05, 0.05)["how"], "below the floor")
        self.assertEqual(to(2)["how"], "before")

    def test_a_speed_up_is_no_more_certain_than_its_times(self):
        measured, late, early = '{value: 8, how: "measured"}', '{value: 16, how: "extrapolated"}', '{value: 2, how: "before"}'
        told = lambda base, mine: self.js(f"const c = speedUpCell({base}, {mine}); return [c.textContent, c.classList.contains('extrapolated')]")
        self.assertEqual(told(measured, '{value: 4, how: "measured"}'), ["2×", False])
        self.assertEqual(told(measured, early), ["≥ 4×", False])
        self.assertEqual(told(early, measured), ["≤ 0.25×", False])
        self.assertEqual(told(early, early), ["–", False])
        self.assertEqual(told(measured, late), ["≈ 0.5×", True])
        self.assertEqual(told(late, measured), ["≈ 2×", True])
        self.assertEqual(told(late, early), ["≥ ≈ 8×", True])
        self.assertEqual(told('{value: null, how: "below the floor"}', measured), ["–", False])
        # An error that no curve has reached: every time is a continuation.
        self.slide("#error", 0)
        told = self.js("return [...document.querySelectorAll('#readout-table td:last-child')].map((n) => n.textContent)")
        self.assertTrue(all(t == "–" or t.startswith("≈") for t in told), told)
        # And one that all have from their first point on: nothing but bounds.
        self.js("chosen.error = 1e9")
        self.slide("#time", 200)
        self.assertEqual(set(self.js("return [...document.querySelectorAll('#readout-table td:last-child')].map((n) => n.textContent)")), {"–"})

    def test_hiding_a_mix_removes_its_curve(self):
        self.click(".chip")
        self.assertEqual(self.js("return document.querySelectorAll('#chart .curve').length"), len(runs.MIXES) - 1)

    def test_images_zoom_together(self):
        from selenium.webdriver.common.action_chains import ActionChains
        from selenium.webdriver.common.actions.wheel_input import ScrollOrigin

        view = self.browser.find(".view")
        self.js("arguments[0].scrollIntoView({block: 'center'})", view)
        ActionChains(self.browser.driver).click(view).perform()
        ActionChains(self.browser.driver).scroll_from_origin(ScrollOrigin.from_element(view, 40, 20), 0, -400).perform()
        self.browser.wait("return viewer.zoom > 1.5")
        placed = self.js("return [...document.querySelectorAll('.view .layer')].map((l) => l.style.transform)")
        self.assertEqual(len(placed), len(runs.MIXES) + 1)
        self.assertEqual(len(set(placed)), 1, placed)
        self.assertNotIn("scale(1)", placed[0])
        before = self.js("return viewer.x")
        ActionChains(self.browser.driver).drag_and_drop_by_offset(view, 30, 0).perform()
        self.assertGreater(self.js("return viewer.x"), before)
        view.send_keys("0")
        self.assertEqual(self.js("return viewer.zoom"), 1)

    def test_the_wheel_scrolls_the_page_until_an_image_is_clicked(self):
        from selenium.webdriver.common.action_chains import ActionChains
        from selenium.webdriver.common.actions.wheel_input import ScrollOrigin

        view = self.browser.find(".view")
        self.js("arguments[0].scrollIntoView({block: 'center'})", view)
        ActionChains(self.browser.driver).scroll_from_origin(ScrollOrigin.from_element(view), 0, -300).perform()
        self.assertEqual(self.js("return viewer.zoom"), 1)

    def test_exposure_and_modes_repaint(self):
        seen = {self.pixels(0)}
        self.slide("#exposure", 6)
        seen.add(self.pixels(0))
        for mode in ("error", "noise", "cost"):
            self.click(f"[data-choice={mode}]")
            seen.add(self.pixels(0))
        self.assertEqual(len(seen), 5)
        self.click("[data-choice=samples]")
        self.assertIn("passes", self.browser.text(".legend"))

    def test_the_page_computes_what_run_json_says(self):
        for i, mix in enumerate(json.loads((RUN / "run.json").read_text())["mixes"]):
            mean = self.js("const s = viewer.shown[arguments[0]]; return d3.mean(errorPlane(s.image, viewer.reference))", i)
            self.assertLess(abs(mean / mix["relmse"] - 1), 2e-3)

    def test_captions_tell_the_pixel_under_the_pointer(self):
        from selenium.webdriver.common.action_chains import ActionChains

        view = self.browser.find(".view")
        self.js("arguments[0].scrollIntoView({block: 'center'})", view)
        ActionChains(self.browser.driver).move_to_element(view).perform()
        self.assertRegex(self.browser.text("#pixel"), r"pixel \d+, \d+")
        self.assertNotIn("relMSE", self.browser.text("figcaption .fig"))

    def test_split_view(self):
        self.click("[data-choice=split]")
        shown = "return [...document.querySelectorAll('figure.image')].filter((f) => f.offsetParent).length"
        self.assertEqual(self.js(shown), 2)
        line = self.browser.find("#split-line")
        before = line.get_attribute("style")
        line.send_keys("\ue012")  # the left arrow
        self.assertNotEqual(line.get_attribute("style"), before)
        self.assertIn("inset(0px 0px 0px 48%)", self.js("return document.querySelector('figure.over .view').style.clipPath"))
        self.click("[data-choice=grid]")
        self.assertEqual(self.js(shown), len(runs.MIXES) + 1)

    def test_regions_are_drawn_and_tabulated(self):
        run = json.loads((RUN / "run.json").read_text())
        self.assertIn(self.js("return significant(arguments[0])", run["mixes"][0]["regions"]["shade"]["relmse"]), self.browser.text("#regions"))
        self.assertEqual(self.js("return document.querySelectorAll('.view')[0].querySelectorAll('.named rect').length"), 2)

    def test_a_region_drawn_on_the_page(self):
        from selenium.webdriver.common.action_chains import ActionChains

        view = self.browser.find(".view")
        self.js("arguments[0].scrollIntoView({block: 'center'})", view)
        self.click("#draw-region")
        ActionChains(self.browser.driver).move_to_element_with_offset(view, -60, -30).click_and_hold().move_by_offset(90, 50).release().perform()
        self.assertRegex(self.browser.text("#selection-flag"), r"--region drawn=\d+,\d+,\d+,\d+")
        self.assertEqual(self.js("return document.querySelectorAll('.view .drawn rect').length"), len(runs.MIXES) + 1)
        self.assertEqual(self.js("return viewer.drawing"), False)
        self.assertEqual(self.js("return viewer.zoom"), 1)

    def test_tiles_budget_and_workers(self):
        self.assertEqual(self.js("return document.querySelectorAll('#tiles .tile').length"), 6)
        self.click("#tiles [data-choice=worker]")
        self.assertIn("of the tiles", self.browser.text("#tile-section"))
        self.assertEqual(self.js("return document.querySelectorAll('#budget .point').length"), len(runs.MIXES))
        self.assertIn("100.0 %" if len(self.js("return run.workers")) == 1 else "%", self.browser.text("#workers"))

    def test_ratios_have_the_intervals_of_independent_errors(self):
        low, high = self.js("return ratioInterval({relmse: 6, relmse_ci: [2, 18]}, {relmse: 3, relmse_ci: [1.5, 6]})")
        width = math.hypot(math.log(3), math.log(2))
        self.assertAlmostEqual(low, 2 * math.exp(-width))
        self.assertAlmostEqual(high, 2 * math.exp(width))
        for unknown in ("null", "[0, 1]"):
            self.assertIsNone(self.js(f"return ratioInterval({{relmse: 6, relmse_ci: {unknown}}}, {{relmse: 3, relmse_ci: [1.5, 6]}})"))
        run = json.loads((RUN / "run.json").read_text())
        best = min(run["mixes"], key=lambda m: m["relmse"])
        for mix in run["mixes"]:
            if mix is best:
                continue
            half = [math.log(m["relmse_ci"][1] / m["relmse_ci"][0]) / 2 for m in (mix, best)]
            ends = [mix["relmse"] / best["relmse"] * math.exp(sign * math.hypot(*half)) for sign in (-1, 1)]
            self.assertIn(self.js("return interval(arguments[0])", ends), self.browser.text("#table"))

    def test_keyboard_reaches_meanings(self):
        self.js("document.querySelector('th .explained').focus()")
        self.assertEqual(self.js("return getComputedStyle(tip).visibility"), "visible")

    def test_every_control_has_a_name(self):
        nameless = self.js("""return [...document.querySelectorAll('button, input, select, [role=slider], [role=img]')].filter((n) =>
          !(n.textContent.trim() && n.tagName === 'BUTTON') && !n.getAttribute('aria-label') && !(n.labels && n.labels.length)).map((n) => n.outerHTML.slice(0, 80))""")
        self.assertEqual(nameless, [])


class Exports(Page):
    def save(self, css):
        """Clicks a button that saves; the file's bytes."""
        with tempfile.TemporaryDirectory() as folder:
            self.browser.driver.execute_cdp_cmd("Browser.setDownloadBehavior", {"behavior": "allow", "downloadPath": folder})
            self.click(css)
            for _ in range(200):
                files = [f for f in pathlib.Path(folder).iterdir() if not f.name.endswith(".crdownload")]
                if files and files[0].stat().st_size > 0:
                    return files[0].name, files[0].read_text(encoding="utf-8")
                time.sleep(0.05)
        self.fail(f"{css}: nothing was saved")

    def test_svg_stands_alone(self):
        for tools, marks in (("#chart-tools", len(runs.MIXES)), ("#budget-tools", 0), ("#tile-tools", 0)):
            name, text = self.save(f"{tools} button")
            self.assertTrue(name.endswith(".svg"), name)
            root = ET.fromstring(text)
            self.assertEqual(root.tag, SVG + "svg")
            self.assertGreater(float(root.get("width")), 300)
            for foreign in ("var(", "class=", "chosen-time", "currentColor"):
                self.assertFalse(foreign in text, foreign)
            if marks:
                bands = [p for p in root.iter(SVG + "path") if p.get("fill-opacity") == "0.13"]
                self.assertEqual(len(bands), marks)
            self.assertRegex(text, r"rgb\(\d+, \d+, \d+\)")

    def test_csv(self):
        run = json.loads((RUN / "run.json").read_text())
        name, text = self.save("#table-tools button:nth-child(1)")
        self.assertTrue(name.endswith(".csv"))
        rows = list(csv.DictReader(io.StringIO(text)))
        self.assertEqual([r["mix"] for r in rows], [m["mix"] for m in run["mixes"]])
        self.assertEqual([float(r["relmse"]) for r in rows], [m["relmse"] for m in run["mixes"]])
        self.assertEqual(float(rows[0]["relmse_ci_low[shade]"]), run["mixes"][0]["regions"]["shade"]["relmse_ci"][0])
        _, text = self.save("#chart-tools button:nth-child(2)")
        rows = list(csv.DictReader(io.StringIO(text)))
        self.assertEqual(len(rows), sum(len(m["timeline"]) for m in run["mixes"]))
        self.assertEqual(self.js("return csvText([['a,\"b\"', 1, null]])"), '"a,""b""",1,\r\n')

    def test_latex(self):
        name, text = self.save("#table-tools button:nth-child(2)")
        self.assertTrue(name.endswith(".tex"))
        columns = len(re.search(r"\\begin\{tabular\}\{(\w+)\}", text).group(1))
        lines = [line for line in text.splitlines() if line.endswith("\\\\")]
        self.assertEqual(len(lines), len(runs.MIXES) + 1)
        for line in lines:
            self.assertEqual(len(re.findall(r"(?<!\\)&", line)) + 1, columns, line)
            self.assertEqual(line.count("{"), line.count("}"), line)
            self.assertEqual(line.count("$") % 2, 0, line)
        self.assertEqual(text.count("\\begin{"), text.count("\\end{"))
        self.assertEqual(text.count("\\textbf"), 1)
        self.assertIn("cells of $2 \\times 2$ pixels", text)
        self.assertNotIn("blocks", text)
        self.assertEqual(self.js("return latexText('a_b%c&d#{e}')"), r"a\_b\%c\&d\#\{e\}")
        self.assertEqual(self.js("return latexNumber(1.234e-5)"), r"$1.23 \times 10^{-5}$")

    def test_prints(self):
        import base64

        pdf = base64.b64decode(self.browser.driver.execute_cdp_cmd("Page.printToPDF", {"preferCSSPageSize": True})["data"])
        self.assertTrue(pdf.startswith(b"%PDF"))
        self.assertGreater(len(pdf), 50_000)
        self.browser.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "print"})
        self.assertEqual(self.js("return getComputedStyle(document.getElementById('controls')).display"), "none")
        self.browser.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": ""})


class Narrow(Page):
    width = 400

    def test_fits(self):
        self.assertEqual(self.js("return document.documentElement.scrollWidth"), 400)
        wide = self.js("return [...document.querySelectorAll('section, .plot svg, .view, #controls')].filter((n) => n.getBoundingClientRect().right > 400)"
                       ".map((n) => n.id || n.className)")
        self.assertEqual(wide, [])


class Dark(Page):
    dark = True

    def luminance(self, css, property):
        """Of a colour of the page, WCAG 2."""
        rgb = self.js("return getComputedStyle(document.querySelector(arguments[0]))[arguments[1]].match(/[\\d.]+/g).slice(0, 3).map(Number)", css, property)
        linear = [c / 255 / 12.92 if c / 255 <= 0.04045 else ((c / 255 + 0.055) / 1.055) ** 2.4 for c in rgb]
        return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]

    def test_is_dark_and_readable_and_can_be_light(self):
        for dark in (True, False):
            ground = self.luminance("section", "backgroundColor")
            self.assertEqual(ground < 0.1, dark)
            for css in ("td", "p.note", "th .explained", "#chart .label"):
                ink = self.luminance(css, "fill" if css.endswith("label") else "color")
                contrast = (max(ink, ground) + 0.05) / (min(ink, ground) + 0.05)
                self.assertGreater(contrast, 4.5, f"{css}, dark={dark}")
            self.click(".head-button")


class WithoutReference(Page):
    run_folder = staticmethod(lambda: ALONE)

    def test_says_what_is_missing_and_estimates(self):
        self.assertIn("No reference was given", self.browser.text("header"))
        self.assertIn("own estimate of relMSE", self.browser.text("#table"))
        self.assertIn("own estimate of relMSE", self.js("return [...document.querySelectorAll('#chart .axis-name')].map((n) => n.textContent).join()"))
        modes = self.js("return [...document.querySelectorAll('#modes button')].map((b) => b.dataset.choice)")
        self.assertEqual(modes, ["colour", "noise", "cost", "samples"])
        self.assertEqual(self.js("return document.querySelectorAll('#chart .curve').length"), len(runs.MIXES))

    def test_regions_that_were_asked_for_want_a_reference(self):
        self.assertRegex(self.browser.text("#regions"), "Asked for: shade.*--reference")
        self.assertNotIn("None was asked for", self.browser.text("#regions"))
        self.assertEqual(self.js("return document.querySelectorAll('.view')[0].querySelectorAll('.named rect').length"), 1)

    def test_the_intervals_of_estimates_are_those_of_blocks(self):
        self.assertIn("resampled $16 \\times 16$ blocks", self.js("return latexTable()"))
        self.assertEqual(self.js("return [...document.querySelectorAll('#table [data-meaning^=\"Error of this mix\"] .ci')].length"), 0)

    def test_a_budget_in_samples_has_no_adherence(self):
        self.assertIn("CPU seconds per mix", self.browser.text("#budget-section h2"))


    def test_has_no_flip_book(self):
        self.assertEqual(self.js("return document.querySelectorAll('#flip-section').length"), 0)


class Large(Page):
    """Shown smaller than it is: figures are those of its own pixels all the same."""
    run_folder = staticmethod(lambda: LARGE)
    whole = "[0, 0, 1101, 961]"

    def mixes(self):
        return enumerate(json.loads((LARGE / "run.json").read_text())["mixes"])

    def test_errors_are_those_of_run_json(self):
        self.assertEqual(self.js("return viewer.reference.scale"), 2)
        for i, mix in self.mixes():
            mean = self.js(f"const s = viewer.shown[arguments[0]]; return meanOver(s.image, errorPlane(s.image, viewer.reference), {self.whole})", i)
            self.assertLess(abs(mean / mix["relmse"] - 1), 2e-3)

    def test_own_noise_is_that_of_run_json(self):
        for i, mix in self.mixes():
            mean = self.js(f"const s = viewer.shown[arguments[0]]; return meanOver(s.image, s.image.noise, {self.whole})", i)
            self.assertLess(abs(mean / mix["estimated_relmse"] - 1), 5e-3)

    def test_a_region_is_drawn_to_the_edge_and_not_beyond(self):
        self.js("""viewer.drawing = true;
          const view = document.querySelector('.view'), box = view.getBoundingClientRect();
          view.setPointerCapture = () => {};
          const at = (type, fx, fy) => view.dispatchEvent(new PointerEvent(type, {clientX: box.left + fx * box.width, clientY: box.top + fy * box.height}));
          at('pointerdown', 0.001, 0.001); at('pointermove', 0.999, 0.999); at('pointerup', 0.999, 0.999);""")
        self.assertIn("--region drawn=0,0,1101,961", self.browser.text("#selection-flag"))
        for _, mix in self.mixes():
            self.assertIn(self.js("return significant(arguments[0], 2)", mix["relmse"])[:3], self.browser.text("#regions"))


class Transient(Page):
    run_folder = staticmethod(lambda: TRANSIENT)

    def shown(self):
        return self.js("return [...document.querySelectorAll('#flips img')].map((i) => i.src)")

    def test_the_slider_turns_the_pages(self):
        self.browser.wait("return [...document.querySelectorAll('#flips img')].every((i) => i.complete && i.naturalWidth === 96)")
        first = self.shown()
        self.assertEqual(len(first), 2)
        seen = set()
        for bin in range(10):
            self.slide("#bin", bin)
            seen.add(self.shown()[0])
            self.assertIn(f"bin {bin} of 10", self.browser.text("#bin-value"))
            self.assertIn(f"{4 * bin} to {4 * bin + 4}", self.browser.text("#bin-value"))
        self.assertGreater(len(seen), 3, "light arrives in several bins")
        self.assertEqual(self.js("return performance.getEntriesByType('resource').filter((e) => !e.name.startsWith('data:')).length"), 0)

    def test_it_plays_and_stops(self):
        self.click("#flip")
        self.browser.wait("return document.getElementById('bin').value !== '0'")
        self.assertEqual(self.browser.text("#flip"), "pause")
        self.click("#flip")
        at = self.js("return document.getElementById('bin').value")
        time.sleep(0.4)
        self.assertEqual(self.js("return document.getElementById('bin').value"), at)

    def test_the_run_says_so(self):
        self.assertIn("transient", self.browser.text("#run"))
        self.assertIn("10 over 0 to 40", self.browser.text("#run"))


if __name__ == "__main__":
    browser.need_browser()
    unittest.main(argv=sys.argv[:1] + sys.argv[3:], verbosity=2)
