//! Rasters of GDAL that consist of others: VRT, and GTI for very many files.
//!
//! Source: GDAL, "VRT -- GDAL Virtual Format", "GTI -- GDAL Raster Tile Index".

use std::io::{self, Write};
use std::ops::Range;

use quick_xml::escape::escape;

use super::{IndexKind, Mosaic};
use crate::raster::{Grid, RasterFormat, Samples, TILE};

/// What bands mean.
const COLOURS: [&str; 4] = ["Red", "Green", "Blue", "Alpha"];

/// Writes a VRT: its elements name all files.
pub(super) fn write_vrt(mosaic: &Mosaic, output: &mut dyn Write) -> io::Result<()> {
    let cells = mosaic.cells();
    let [columns, rows] = cells.each_ref().map(|cells| cells.end - cells.start);
    writeln!(output, "<VRTDataset rasterXSize=\"{columns}\" rasterYSize=\"{rows}\">")?;
    if let Some(system) = mosaic.system() {
        writeln!(output, "  <SRS>{}</SRS>", escape(&system))?;
    }
    let Grid { left, top, step, .. } = mosaic.file.grid.part(&cells);
    writeln!(output, "  <GeoTransform>{left}, {step}, 0, {top}, 0, -{step}</GeoTransform>")?;
    let name = mosaic.file.cell_type().name();
    for band in 1..=mosaic.file.samples.bands() {
        writeln!(output, "  <VRTRasterBand dataType=\"{name}\" band=\"{band}\">")?;
        write_band(mosaic, band, output)?;
        for sheet in mosaic.sheets() {
            write_source(mosaic, band, &sheet.file_name, [&cells, &sheet.cells], output)?;
        }
        writeln!(output, "  </VRTRasterBand>")?;
    }
    writeln!(output, "</VRTDataset>")
}

/// Writes a file of a band of a VRT.
fn write_source(
    mosaic: &Mosaic,
    band: usize,
    file_name: &str,
    [whole, part]: [&[Range<i64>; 2]; 2],
    output: &mut dyn Write,
) -> io::Result<()> {
    let [columns, rows] = part.each_ref().map(|cells| cells.end - cells.start);
    let [column, row] = [0, 1].map(|axis| part[axis].start - whole[axis].start);
    // Cells without data must not hide those of a neighbour's margin.
    let kind = if mosaic.file.samples == Samples::Colours { "SimpleSource" } else { "ComplexSource" };
    writeln!(output, "    <{kind}>")?;
    let name = escape(file_name);
    writeln!(output, "      <SourceFilename relativeToVRT=\"1\">{name}</SourceFilename>")?;
    writeln!(output, "      <SourceBand>{band}</SourceBand>")?;
    // With these, GDAL opens a file only when its cells are asked for.
    if mosaic.file.options.format == RasterFormat::GeoTiff {
        let cell_type = mosaic.file.cell_type().name();
        writeln!(
            output,
            "      <SourceProperties RasterXSize=\"{columns}\" RasterYSize=\"{rows}\" DataType=\"{cell_type}\" \
             BlockXSize=\"{TILE}\" BlockYSize=\"{TILE}\"/>"
        )?;
    }
    writeln!(output, "      <SrcRect xOff=\"0\" yOff=\"0\" xSize=\"{columns}\" ySize=\"{rows}\"/>")?;
    writeln!(
        output,
        "      <DstRect xOff=\"{column}\" yOff=\"{row}\" xSize=\"{columns}\" ySize=\"{rows}\"/>"
    )?;
    if mosaic.file.samples != Samples::Colours {
        writeln!(output, "      <NODATA>{}</NODATA>", mosaic.file.no_data_text())?;
    }
    writeln!(output, "    </{kind}>")
}

/// Writes a GTI, which takes the files from the GeoJSON beside it.
pub(super) fn write_gti(mosaic: &Mosaic, output: &mut dyn Write) -> io::Result<()> {
    let cells = mosaic.cells();
    let [columns, rows] = cells.each_ref().map(|cells| cells.end - cells.start);
    let name = format!("{}/{}.{}", mosaic.folder, mosaic.name, IndexKind::GeoJson.ending());
    writeln!(output, "<GDALTileIndexDataset>")?;
    writeln!(output, "  <IndexDataset>{}</IndexDataset>", escape(&name))?;
    writeln!(output, "  <LocationField>location</LocationField>")?;
    if let Some(system) = mosaic.system() {
        writeln!(output, "  <SRS>{}</SRS>", escape(&system))?;
    }
    let Grid { left, top, step, .. } = mosaic.file.grid.part(&cells);
    writeln!(output, "  <GeoTransform>{left},{step},0,{top},0,-{step}</GeoTransform>")?;
    writeln!(output, "  <XSize>{columns}</XSize>\n  <YSize>{rows}</YSize>")?;
    let cell_type = mosaic.file.cell_type().name();
    for band in 1..=mosaic.file.samples.bands() {
        writeln!(output, "  <Band band=\"{band}\" dataType=\"{cell_type}\">")?;
        write_band(mosaic, band, output)?;
        writeln!(output, "  </Band>")?;
    }
    writeln!(output, "</GDALTileIndexDataset>")
}

/// Writes what both say of a band.
fn write_band(mosaic: &Mosaic, band: usize, output: &mut dyn Write) -> io::Result<()> {
    let is_coloured = mosaic.file.samples == Samples::Colours;
    if let Some([scale, offset]) = mosaic.file.transform() {
        writeln!(output, "    <Offset>{offset}</Offset>\n    <Scale>{scale}</Scale>")?;
    }
    if !is_coloured {
        writeln!(output, "    <NoDataValue>{}</NoDataValue>", mosaic.file.no_data_text())?;
    }
    if let Some(unit) = &mosaic.file.reference.unit {
        writeln!(output, "    <UnitType>{}</UnitType>", escape(unit))?;
    }
    let meaning = if is_coloured { COLOURS[band - 1] } else { "Gray" };
    writeln!(output, "    <ColorInterp>{meaning}</ColorInterp>")
}
