#!/usr/bin/python3
"""The report in a real browser: it opens without errors and without network, charts zoom and point
together, series and marks switch, playback moves the body, exports hold what is shown."""
import math
import time

from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By

from browser import SHOTS, Browser, main, sim

POSES = "model:optical+rest:1+reach:0.7:8+gap:0.4+turn:1:10+oscillate:4:1+lose:position:0.5+rest:1"
IMU = "model:icm42688p+rest:4+turn:1.5:3+reach:0.8:4+gap:0.3+turn:1+rest:2"


def opened(page, folder, spec=POSES, filters="binomial:9"):
    recording = folder / ("in.imu" if "icm" in spec else "in.trk")
    sim("generate", spec, "--seed", 3, "--out", recording)
    sim("replay", recording, "--filter", filters, "--out", folder)
    page.driver.get((folder / "report.html").as_uri())
    page.until("document.documentElement.dataset.ready", "the report is ready")
    assert page.errors() == [], page.errors()


def windows(page):
    return page.run("return report.group.charts.map((c) => c.graph.xAxisRange())")


def values(page):
    return page.run("return [...document.querySelectorAll('.legend output')].map((o) => o.value)")


def plot(page, index):
    return page.driver.find_elements(By.CSS_SELECTOR, ".plot")[index]


def same(ranges):
    return all(abs(a - b) < 1e-9 for r in ranges for a, b in zip(r, ranges[0]))


def test_it_opens_without_errors_and_asks_nothing_of_the_network(folder):
    with Browser(folder) as page:
        opened(page, folder)
        assert page.run("return performance.getEntriesByType('resource').length") == 0
        charts = page.run("return report.group.charts.map((c) => c.data.id)")
        assert charts[:3] == ["position", "position_difference", "position_error"], charts
        assert "orientation" in charts and "delay" in charts, charts
        assert page.run("return report.view !== null"), "the body needs WebGL"
        page.shot("report")
        page.run("document.getElementById('chart-position').scrollIntoView()")
        page.shot("report_charts")


def test_zoom_moves_all_charts(folder):
    with Browser(folder) as page:
        opened(page, folder)
        whole = windows(page)
        assert len(whole) >= 6 and same(whole)
        element = plot(page, 0)
        page.run("arguments[0].scrollIntoView({block: 'center'})", element)
        ActionChains(page.driver).move_to_element_with_offset(element, -150, 0).click_and_hold() \
            .move_by_offset(120, 0).move_by_offset(80, 0).release().perform()
        zoomed = windows(page)
        assert same(zoomed), zoomed
        width = zoomed[0][1] - zoomed[0][0]
        assert 0.05 < width / (whole[0][1] - whole[0][0]) < 0.4, zoomed
        page.run("document.getElementById('all').click()")
        assert same(windows(page)) and windows(page)[0] == whole[0]


def test_one_cursor_shows_values_in_all_charts(folder):
    with Browser(folder) as page:
        opened(page, folder)
        seen = []
        for offset in (-200, 0, 200):
            element = plot(page, 1)
            page.run("arguments[0].scrollIntoView({block: 'center'})", element)
            ActionChains(page.driver).move_to_element_with_offset(element, offset, 0).perform()
            t = page.run("return report.group.cursor")
            lines = page.run("return report.group.charts.map((c) => "
                             "c.graph.toDataXCoord(parseFloat(c.line.style.left)))")
            assert all(abs(x - t) < 1e-6 for x in lines), (t, lines)
            assert abs(float(page.run("return scrub.value")) - t) < 1e-6
            seen.append((t, tuple(values(page))))
        assert len({t for t, _ in seen}) == 3 and len({v for _, v in seen}) == 3
        # the values are those of the data at that time, not of the pixels
        assert page.run("""const c = report.group.charts[0], s = c.data.series[3], t = report.group.cursor;
            let best = 0; s.x.forEach((x, i) => { if (Math.abs(x - t) < Math.abs(s.x[best] - t)) best = i; });
            const shown = parseFloat(c.outputs[3].value);
            return Math.abs(shown - s.y[best]) <= 1e-4 * Math.max(1, Math.abs(shown));""")


def test_every_peak_is_shown_at_every_zoom(folder):
    with Browser(folder) as page:
        opened(page, folder)
        assert page.run("""for (const c of report.group.charts) for (const [k, s] of c.data.series.entries()) {
              const finite = [...s.y].filter((v) => !Number.isNaN(v));
              const drawn = c.graph.rawData_.map((r) => r[k + 1]).filter((v) => v !== null && !Number.isNaN(v));
              if (Math.max(...finite) !== Math.max(...drawn) || Math.min(...finite) !== Math.min(...drawn))
                return c.data.id + ' ' + s.name;
            } return '';""") == ""


def test_switches_hide_series_marks_and_bands(folder):
    with Browser(folder) as page:
        opened(page, folder, IMU, "")
        page.driver.find_elements(By.CSS_SELECTOR, ".legend input")[0].click()
        assert page.run("return report.group.charts[0].graph.visibility()[0]") is False
        bands = page.run("return report.group.bands.map((b) => b.name)")
        assert {"gap", "settling", "rest"} <= set(bands), bands
        marks = page.run("return report.group.marks.map((m) => [m.name, m.times.length])")
        assert any("knots" in n and c > 10 for n, c in marks) and any(n == "frames" for n, c in marks)
        before = page.run("return document.querySelector('.plot canvas').toDataURL()")
        for box in page.driver.find_elements(By.CSS_SELECTOR, ".marks input"):
            page.run("arguments[0].click()", box)
        assert page.run("return report.group.bands.every((b) => !b.on)")
        assert page.run("return document.querySelector('.plot canvas').toDataURL()") != before
        page.shot("report_imu")


def body_state(page):
    return page.run("const s = report.view.solid; return [...s.quaternion.toArray(), ...s.position.toArray()]")


def test_playback_moves_the_body(folder):
    with Browser(folder) as page:
        opened(page, folder)
        page.run("report.group.setCursor(1.2)")
        first, pixels = body_state(page), page.run(
            "report.view.render(); return report.view.renderer.domElement.toDataURL()")
        page.run("speed.value = '2'; play.click()")
        time.sleep(1.0)
        page.run("play.click()")
        t = page.run("return report.group.cursor")
        assert 1.2 + 0.8 < t < 1.2 + 8, t
        assert body_state(page) != first
        assert page.run("report.view.render(); return report.view.renderer.domElement.toDataURL()") != pixels
        time.sleep(0.2)
        assert page.run("return report.group.cursor") == t, "paused"
        page.run("scrub.value = 1.2; scrub.oninput()")
        assert body_state(page) == first, "scrubbing back shows the same pose"


def test_exports_hold_what_is_shown(folder):
    with Browser(folder) as page:
        opened(page, folder)
        page.run("report.group.setWindow(2, 4)")
        csv = page.run("return report.group.charts[0].csv()").splitlines()
        assert csv[0].startswith('"t [s]","sensor x [m]"'), csv[0]
        stamps = [float(line.split(",")[0]) for line in csv[1:]]
        assert len(stamps) > 200 and min(stamps) >= 2 and max(stamps) <= 4 and stamps == sorted(stamps)
        svg = page.run("const s = report.group.charts[0].svg();"
                       "const d = new DOMParser().parseFromString(s, 'image/svg+xml');"
                       "return [d.querySelector('parsererror') === null, d.querySelectorAll('path').length,"
                       " Math.max(...[...d.querySelectorAll('path')].map((p) => p.getAttribute('d').length))]")
        assert svg[0] and svg[1] > 10 and svg[2] > 2000, svg
        page.driver.find_element(By.CSS_SELECTOR, "#chart-position .csv").click()
        end = time.monotonic() + 10
        while not (folder / "position.csv").exists() and time.monotonic() < end:
            time.sleep(0.1)
        assert (folder / "position.csv").read_text().splitlines() == csv


def test_dark_light_and_a_phone(folder):
    with Browser(folder) as page:
        page.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", {
            "width": 390, "height": 800, "deviceScaleFactor": 2, "mobile": True})
        opened(page, folder)
        assert page.run("return innerWidth") == 390
        assert page.run("return document.documentElement.scrollWidth <= innerWidth"), "no sideways scrolling"
        colours = set()
        for _ in range(2):
            page.run("theme.click()")
            colours.add(page.run("return getComputedStyle(document.body).backgroundColor"))
            page.run("document.getElementById('chart-orientation').scrollIntoView()")
            page.shot(f"report_phone_{len(colours)}")
        assert len(colours) == 2, colours
        widths = page.run("return [...document.querySelectorAll('.plot')].map((p) => p.clientWidth)")
        assert all(w > 280 for w in widths), widths


def test_rotation_vectors_do_not_jump(folder):
    """A body that spins about a fixed axis: the angle grows over many turns."""
    rows = ["t_ns,qw,qx,qy,qz"]
    for i in range(2000):
        half = 0.03 * i
        rows.append(f"{i * 10000000},{math.cos(half):.9f},{0.6 * math.sin(half):.9f},0,{0.8 * math.sin(half):.9f}")
    (folder / "spin.csv").write_text("\n".join(rows) + "\n")
    sim("replay", folder / "spin.csv", "--out", folder)
    with Browser(folder) as page:
        page.driver.get((folder / "report.html").as_uri())
        page.until("document.documentElement.dataset.ready", "the report is ready")
        jump, last = page.run("""const c = report.group.charts.find((c) => c.data.id === 'orientation');
            let most = 0; for (const s of c.data.series) for (let i = 1; i < s.y.length; ++i)
              most = Math.max(most, Math.abs(s.y[i] - s.y[i - 1]) || 0); return [most, c.data.series[5].y.at(-1)];""")
        assert jump < 5, jump
        assert abs(last - 0.8 * math.degrees(0.06 * 1999)) < 1, last


def test_a_long_recording_stays_small_and_opens_fast(folder):
    """194 s of an IMU at 285.7 Hz: below 4 MB; how long it takes to open is printed."""
    spec = "model:icm42688p+rate:285.714+rest:4+" + "+".join(["reach:0.8:20", "oscillate:20:1.2", "turn:1.5:6"] * 5) + "+rest:5"
    with Browser(folder) as page:
        opened(page, folder, spec, "")
        page.shot("report_long")
        seconds, size = page.run("return report.data.end"), (folder / "report.html").stat().st_size
        assert seconds > 180 and size < 4e6 * seconds / 194, (seconds, size)
        zoom = page.run("const t = performance.now(); report.group.setWindow(20, 30); return performance.now() - t")
        ready = float(page.run("return document.documentElement.dataset.ready"))
        memory = page.memory()
        assert ready < 20000 and 1e6 < memory < 400e6, (ready, memory)
        figures = (f"{seconds:.0f} s of an IMU: {size / 1e6:.2f} MB, ready after {ready:.0f} ms, "
                   f"a zoom takes {zoom:.0f} ms, {memory / 1e6:.0f} MB of the browser's memory\n")
        (SHOTS / "figures.txt").write_text(figures)


if __name__ == "__main__":
    main()
