"""Headless Chromium for the tests: Debian's chromium, chromium-driver and python3-selenium."""
import shutil
import sys

SKIP = 77  # ctest's SKIP_RETURN_CODE


def skip(reason):
    """Ends the program so that ctest shows a skipped test."""
    print(f"SKIPPED: {reason}", flush=True)
    sys.exit(SKIP)


def need_browser():
    for program in ("chromium", "chromedriver"):
        if shutil.which(program) is None:
            skip(f"{program} is not installed (deploy/packages.txt lists it)")
    try:
        import selenium  # noqa: F401
    except ImportError:
        skip("python3-selenium is not installed (deploy/packages.txt lists it)")


class Browser:
    """One window. `with Browser(1280, 900) as b: b.open(url)`."""

    def __init__(self, width, height, dark=False, insecure=False):
        from selenium import webdriver
        from selenium.webdriver.chrome.service import Service

        options = webdriver.ChromeOptions()
        # As root, in containers: no sandbox; its own /dev/shm may be small.
        for flag in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--hide-scrollbars", "--disable-gpu"):
            options.add_argument(flag)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
        options.accept_insecure_certs = insecure
        self.driver = webdriver.Chrome(service=Service(shutil.which("chromedriver")), options=options)
        self.resize(width, height)
        self.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {
            "features": [{"name": "prefers-color-scheme", "value": "dark" if dark else "light"}]})

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.driver.quit()

    def resize(self, width, height):
        """The page's own size: a window cannot be made as narrow as a telephone."""
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {
            "width": width, "height": height, "deviceScaleFactor": 1, "mobile": False})

    def open(self, url, ready="return document.body.hasAttribute('data-ready')", seconds=60):
        self.driver.get(url)
        self.wait(ready, seconds)

    def run(self, script, *arguments):
        """The value of a script with `return`. Names at the top of the page's scripts can be used."""
        return self.driver.execute_script(script, *arguments)

    def wait(self, script, seconds=30):
        from selenium.webdriver.support.ui import WebDriverWait

        WebDriverWait(self.driver, seconds, poll_frequency=0.05).until(lambda _: self.run(script), f"never true: {script}")

    def find(self, css):
        from selenium.webdriver.common.by import By

        return self.driver.find_element(By.CSS_SELECTOR, css)

    def text(self, css):
        return self.find(css).text

    def complaints(self):
        """What the console holds at level WARNING and above."""
        return [e for e in self.driver.get_log("browser") if e["level"] in ("SEVERE", "WARNING")]

    def whole_page(self, path):
        """A picture of the page from top to bottom."""
        import base64

        size = self.driver.execute_cdp_cmd("Page.getLayoutMetrics", {})["cssContentSize"]
        shot = self.driver.execute_cdp_cmd("Page.captureScreenshot", {
            "captureBeyondViewport": True, "clip": {"x": 0, "y": 0, "width": size["width"], "height": size["height"], "scale": 1}})
        with open(path, "wb") as file:
            file.write(base64.b64decode(shot["data"]))
