#!/usr/bin/env python3
"""Writes tests/data/lines.*: the same lines as text, GeoJSON, Shapefile and GeoPackage. Needs only Python."""

import json
import os
import sqlite3
import struct

FOLDER = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "tests", "data")
NAN = float("nan")

# x, y, z; coordinates are multiples of 1/8, so that all formats hold them exactly.
LINES = [
    [(1, 1, 10), (5.5, 2, 11), (9, 8, 12.5)],
    [(1, 8, 9), (9, 1, 7)],
    [(2, 3, 4), (2, 3, 4), (4, 3, 5), (2, 3, 4)],
]
RING = [(6, 5, 3), (8, 5, 3), (8, 7, 3), (6, 7, 3), (6, 5, 3)]
WKT = (
    'PROJCS["ETRS89 / UTM zone 32N",GEOGCS["ETRS89",DATUM["European_Terrestrial_Reference_System_1989",'
    'SPHEROID["GRS 1980",6378137,298.257222101]],PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]],'
    'PROJECTION["Transverse_Mercator"],PARAMETER["latitude_of_origin",0],PARAMETER["central_meridian",9],'
    'PARAMETER["scale_factor",0.9996],PARAMETER["false_easting",500000],PARAMETER["false_northing",0],'
    'UNIT["metre",1],AUTHORITY["EPSG","25832"]]'
)


def path(name):
    return os.path.join(FOLDER, name)


def text():
    with open(path("lines.txt"), "w") as file:
        file.write("# Lines with elevations; a ring last.\n")
        for line in LINES + [RING]:
            file.write("line\n")
            for vertex in line:
                file.write("  %g %g %g\n" % vertex)


def geojson():
    lines = [{"type": "LineString", "coordinates": line} for line in LINES]
    polygon = {"type": "Polygon", "coordinates": [RING]}
    features = [{"type": "Feature", "properties": {}, "geometry": g} for g in lines + [polygon]]
    crs = {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::25832"}}
    with open(path("lines.geojson"), "w") as file:
        json.dump({"type": "FeatureCollection", "crs": crs, "features": features}, file, indent=1)
        file.write("\n")


def shapefile():
    """Type 13, PolyLineZ; the ring is a line, as a file has one type."""
    records = b""
    xs, ys, zs = zip(*(vertex for line in LINES + [RING] for vertex in line))
    for number, line in enumerate(LINES + [RING], 1):
        x, y, z = zip(*line)
        content = struct.pack("<i4d2ii", 13, min(x), min(y), max(x), max(y), 1, len(line), 0)
        content += b"".join(struct.pack("<2d", *vertex[:2]) for vertex in line)
        content += struct.pack("<2d", min(z), max(z)) + struct.pack("<%dd" % len(z), *z)
        content += struct.pack("<2d", 0, 0) + struct.pack("<%dd" % len(z), *[0] * len(z))
        records += struct.pack(">2i", number, len(content) // 2) + content
    box = struct.pack("<8d", min(xs), min(ys), max(xs), max(ys), min(zs), max(zs), 0, 0)
    head = struct.pack(">7i", 9994, 0, 0, 0, 0, 0, (100 + len(records)) // 2) + struct.pack("<2i", 1000, 13)
    with open(path("lines.shp"), "wb") as file:
        file.write(head + box + records)
    with open(path("lines.prj"), "w") as file:
        file.write(WKT)


def wkb(kind, parts):
    """Lines (2) or polygons (3) with z."""
    bytes_ = struct.pack("<BI", 1, 1000 + kind)
    if kind == 3:
        bytes_ += struct.pack("<I", len(parts))
    for part in parts:
        bytes_ += struct.pack("<I", len(part)) + b"".join(struct.pack("<3d", *vertex) for vertex in part)
    return b"GP\0\1" + struct.pack("<i", 25832) + bytes_


def geopackage():
    if os.path.exists(path("lines.gpkg")):
        os.remove(path("lines.gpkg"))
    database = sqlite3.connect(path("lines.gpkg"))
    database.executescript(
        "PRAGMA page_size = 1024; PRAGMA application_id = 1196444487; PRAGMA user_version = 10400;"
        "CREATE TABLE gpkg_spatial_ref_sys (srs_name TEXT NOT NULL, srs_id INTEGER PRIMARY KEY, organization TEXT"
        " NOT NULL, organization_coordsys_id INTEGER NOT NULL, definition TEXT NOT NULL, description TEXT);"
        "CREATE TABLE gpkg_contents (table_name TEXT PRIMARY KEY, data_type TEXT NOT NULL, identifier TEXT,"
        " description TEXT, last_change DATETIME, min_x DOUBLE, min_y DOUBLE, max_x DOUBLE, max_y DOUBLE,"
        " srs_id INTEGER);"
        "CREATE TABLE gpkg_geometry_columns (table_name TEXT NOT NULL, column_name TEXT NOT NULL,"
        " geometry_type_name TEXT NOT NULL, srs_id INTEGER NOT NULL, z TINYINT NOT NULL, m TINYINT NOT NULL,"
        " PRIMARY KEY (table_name, column_name));"
        "CREATE TABLE paths (fid INTEGER PRIMARY KEY, geom LINESTRING);"
        "CREATE TABLE ponds (fid INTEGER PRIMARY KEY, geom POLYGON);"
        "CREATE TABLE notes (id INTEGER PRIMARY KEY, text TEXT);"
    )
    database.execute("INSERT INTO gpkg_spatial_ref_sys VALUES (?, 25832, 'EPSG', 25832, ?, '')", ("UTM 32N", WKT))
    for table, kind in [("paths", "LINESTRING"), ("ponds", "POLYGON")]:
        database.execute(
            "INSERT INTO gpkg_contents VALUES (?, 'features', ?, '', '2026-01-01T00:00:00Z', 1, 1, 9, 8, 25832)",
            (table, table),
        )
        database.execute("INSERT INTO gpkg_geometry_columns VALUES (?, 'geom', ?, 25832, 1, 0)", (table, kind))
    for line in LINES:
        database.execute("INSERT INTO paths (geom) VALUES (?)", (wkb(2, [line]),))
    database.execute("INSERT INTO paths (geom) VALUES (NULL)")
    database.execute("INSERT INTO ponds (geom) VALUES (?)", (wkb(3, [RING]),))
    database.commit()
    database.execute("VACUUM")
    database.close()


if __name__ == "__main__":
    text()
    geojson()
    shapefile()
    geopackage()
