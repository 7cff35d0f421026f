"""Panels in a grid, each with a title and a window of coordinates."""

from svg import TEXT, document, text

SIDE, GAP, TITLE, MARGIN = 300, 34, 26, 16


class Panel:
    """A panel in a column and a row; `across` and `up` are the ranges of its coordinates. Without `is_free`,
    both axes have the same scale."""

    def __init__(self, column, row, title, across, up, is_free=False, side=SIDE):
        self.left = MARGIN + column * (side + GAP)
        self.top = MARGIN + row * (side + GAP + TITLE) + TITLE
        self.side, self.origin = side, (across[0], up[0])
        scales = [side / (high - low) for low, high in (across, up)]
        self.scales = scales if is_free else [min(scales)] * 2
        used = [(high - low) * scale for (low, high), scale in zip((across, up), self.scales, strict=True)]
        self.start = self.left + (side - used[0]) / 2, self.top + side - (side - used[1]) / 2
        self.parts = [text(self.left, self.top - 10, title, css="title")]

    def at(self, place):
        x, y = ((place[axis] - self.origin[axis]) * self.scales[axis] for axis in (0, 1))
        return self.start[0] + x, self.start[1] - y

    def polygon(self, places, fill, opacity=1.0, stroke="none", width=1.0):
        style = f'fill="{fill}" fill-opacity="{opacity}" stroke="{stroke}" stroke-width="{width}"'
        self.parts.append(f'<polygon points="{self.points(places)}" {style} stroke-linejoin="round"/>')

    def line(self, places, colour, width=1.5, dash=""):
        dashes = f' stroke-dasharray="{dash}"' if dash else ""
        style = f'fill="none" stroke="{colour}" stroke-width="{width}"{dashes} stroke-linejoin="round"'
        self.parts.append(f'<polyline points="{self.points(places)}" {style}/>')

    def dots(self, places, colour=TEXT, size=3.5):
        for x, y in map(self.at, places):
            self.parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{size}" fill="{colour}"/>')

    def label(self, place, words, dx=0, dy=0, anchor="middle", fill=""):
        x, y = self.at(place)
        self.parts.append(text(x + dx, y + dy, words, anchor, fill=fill))

    def points(self, places):
        return " ".join(f"{x:.1f},{y:.1f}" for x, y in map(self.at, places))


def figure(path, alt, panels, parts=(), below=0):
    """Writes panels as SVG, with room for other parts below."""
    width = max(panel.left + panel.side for panel in panels) + MARGIN
    height = max(panel.top + panel.side for panel in panels) + MARGIN + below
    path.write_text(document(width, height, alt, [*(part for panel in panels for part in panel.parts), *parts]))
