"""What the browser tests share: headless Chromium with a new profile, driven by its own driver."""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time

from selenium import webdriver
from selenium.webdriver.chrome.service import Service

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = ROOT / os.environ.get("BUILD", "build")
FLAGS = ("--headless=new --no-sandbox --disable-gpu --disable-quic --no-first-run "
         "--disable-background-networking --disable-component-update --disable-sync "
         "--use-angle=swiftshader --enable-unsafe-swiftshader --hide-scrollbars").split()
SHOTS = BUILD / "browser"


class Browser:
    """A context: `with Browser(folder) as page:`; errors of the page's scripts are failures."""

    def __init__(self, folder, width=1200, height=900, dark=False):
        options = webdriver.ChromeOptions()
        options.binary_location = shutil.which("chromium")
        for flag in (*FLAGS, f"--window-size={width},{height}", f"--user-data-dir={folder}/profile"):
            options.add_argument(flag)
        if dark:
            options.add_argument("--blink-settings=preferredColorScheme=0")
        options.add_experimental_option("prefs", {"download.default_directory": str(folder)})
        options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
        self.driver = webdriver.Chrome(service=Service(shutil.which("chromedriver")), options=options)
        self.driver.set_page_load_timeout(60)
        self.driver.set_script_timeout(60)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.driver.quit()

    def run(self, script, *arguments):
        return self.driver.execute_script(script, *arguments)

    def until(self, script, what, seconds=30):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            value = self.run("return " + script)
            if value:
                return value
            time.sleep(0.05)
        raise AssertionError(f"{what}: not within {seconds} s")

    def errors(self):
        return [e["message"] for e in self.driver.get_log("browser") if e["level"] == "SEVERE"]

    def memory(self):
        """Bytes that the page's scripts and its buffers of numbers hold, after a collection."""
        self.driver.execute_cdp_cmd("HeapProfiler.collectGarbage", {})
        usage = self.driver.execute_cdp_cmd("Runtime.getHeapUsage", {})
        return usage["usedSize"] + usage.get("backingStorageSize", 0)

    def shot(self, name):
        SHOTS.mkdir(parents=True, exist_ok=True)
        self.driver.save_screenshot(str(SHOTS / f"{name}.png"))


def sim(*arguments):
    subprocess.run([BUILD / "fairlead-sim", *map(str, arguments)], check=True, timeout=300,
                   capture_output=True)


def main(module="__main__"):
    """Runs the test_ functions of a script; lines as tests/run counts them."""
    failed = 0
    for name, test in list(vars(sys.modules[module]).items()):
        if not name.startswith("test_") or (sys.argv[1:] and name not in sys.argv[1:]) or not callable(test):
            continue
        with tempfile.TemporaryDirectory(prefix="fairlead-browser-") as folder:
            try:
                test(pathlib.Path(folder))
                print("ok", name, flush=True)
            except Exception as error:  # pylint: disable=broad-except
                failed += 1
                print("FAIL", name, type(error).__name__, error, flush=True)
    sys.exit(1 if failed else 0)
