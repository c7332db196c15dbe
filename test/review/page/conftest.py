# SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
# SPDX-License-Identifier: Apache-2.0
"""The review page in a headless Chromium as a person sees and uses it."""

import json
from collections.abc import Callable, Iterator
from functools import partial

import pytest

try:
    from selenium.common.exceptions import NoSuchElementException, StaleElementReferenceException
    from selenium.webdriver.common.action_chains import ActionChains
    from selenium.webdriver.support.ui import WebDriverWait
except ModuleNotFoundError:  # the browser fixture says so
    pass

CSS = "css selector"


class Page:
    """The page as a person sees it."""

    def __init__(self, browser, url: str, picture: bool = True) -> None:
        self.browser = browser
        browser.get(url)
        self.wait(lambda: self.all("#canvas img" if picture else "#canvas svg"))

    @staticmethod
    def resize(browser, width: int, height: int) -> None:
        """Make the window as wide as a screen, or as a phone's."""
        metrics = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 600}
        browser.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", metrics)

    def wait(self, condition: Callable[[], object]) -> None:
        """Wait until a condition holds; one that asks while the page draws anew is asked again."""
        drawn_anew = (NoSuchElementException, StaleElementReferenceException, IndexError)
        wait = WebDriverWait(self.browser, 20, poll_frequency=0.02, ignored_exceptions=drawn_anew)
        wait.until(lambda _: condition())

    def find(self, selector: str):
        return self.browser.find_element(CSS, selector)

    def all(self, selector: str) -> list:
        return self.browser.find_elements(CSS, selector)

    def text(self, name: str) -> str:
        return self.find(f"#{name}").text

    @property
    def frame(self) -> int:
        return int(self.find("#number").get_property("value"))

    @property
    def table(self) -> tuple[str, ...]:
        return tuple(self.text(name) for name in ("sequence", "total", "incorrect", "missed", "precision"))

    @property
    def chosen(self) -> dict[str, str]:
        """The verdicts that are shown as given, by side."""
        pressed = self.all("fieldset button[aria-pressed=true]")
        sides = [button.find_element("xpath", "..").get_attribute("data-side") for button in pressed]
        return {
            side: button.get_attribute("data-verdict") for side, button in zip(sides, pressed, strict=True)
        }

    def type(self, *keys: str) -> None:
        actions = ActionChains(self.browser)
        for key in keys:
            actions.send_keys(key)
        actions.perform()

    def click(self, selector: str) -> None:
        self.find(selector).click()

    def verdict(self, side: str, verdict: str) -> None:
        self.click(f"[data-side={side}] [data-verdict={verdict}]")

    def drag(self, element, du: int, dv: int) -> None:
        """Drag an element by screen pixels."""
        actions = ActionChains(self.browser).move_to_element(element).click_and_hold()
        actions.move_by_offset(du // 2, dv // 2).move_by_offset(
            du - du // 2, dv - dv // 2
        ).release().perform()

    def double_click(self, selector: str, du: float, dv: float) -> None:
        """Double-click at an offset [screen pixels] from an element's centre."""
        actions = ActionChains(self.browser)
        actions.move_to_element_with_offset(
            self.find(selector), round(du), round(dv)
        ).double_click().perform()

    def until_said(self, text: str) -> None:
        self.wait(lambda: text in self.text("status"))

    def until_pictures_fetched(self, count: int) -> None:
        """Wait until so many pictures have come: those of the frames around are fetched ahead."""
        script = (
            "return performance.getEntriesByType('resource')"
            ".filter((each) => each.name.includes('/pictures/') && each.responseStatus === 200).length"
        )
        self.wait(lambda: self.browser.execute_script(script) >= count)

    def until_frame(self, number: int) -> None:
        self.wait(lambda: self.frame == number)


@pytest.fixture
def open_page(browser) -> Iterator[Callable[..., Page]]:
    """Return a function that opens a page; nothing may go wrong in it, nor leave this machine."""
    Page.resize(browser, 1280, 1000)
    browser.get_log("browser")
    browser.get_log("performance")
    yield partial(Page, browser)
    assert browser.get_log("browser") == []
    events = [json.loads(entry["message"])["message"] for entry in browser.get_log("performance")]
    urls = {e["params"]["request"]["url"] for e in events if e["method"] == "Network.requestWillBeSent"}
    assert urls
    assert {
        url for url in urls if not url.startswith(("http://127.0.0.1:", "blob:http://127.0.0.1:"))
    } == set()
