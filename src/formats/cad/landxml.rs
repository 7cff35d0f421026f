//! Writes LandXML 1.2, in which surveyors exchange surfaces.
//!
//! Source: the schema LandXML-1.2 (landxml.org). A point is northing, easting and elevation, in this order.

use std::io::Write;

use crate::crs::{System, Unit};
use crate::sink::constrained::Surveyed;
use crate::sink::spool::Spool;
use crate::sink::{EventSink, SinkOptions, expect_kind, lost_attributes, write_error};
use spmesh_base::error::Result;
use spmesh_stream::model::bounds::Point;
use spmesh_stream::model::decimal::Decimal;
use spmesh_stream::{Crs, Event, Header, Kind};

/// Writes a triangle mesh as a surface: points and faces, and a breakline for each edge on a line, which has
/// the number of the line as its name.
///
/// All points come before all faces, so faces and breaklines wait in unnamed temporary files. Memory: the
/// width of the stream, and 4 bytes per segment. The schema wants a date: it is always that of the Unix
/// epoch, so that equal meshes become equal files.
pub struct LandXmlSink<W> {
    output: W,
    mesh: Surveyed,
    faces: Spool,
    breaklines: Spool,
    vertices: u64,
}

const START: &str = "\
<?xml version=\"1.0\" encoding=\"UTF-8\"?>
<LandXML xmlns=\"http://www.landxml.org/schema/LandXML-1.2\" \
xmlns:xsi=\"http://www.w3.org/2001/XMLSchema-instance\" \
xsi:schemaLocation=\"http://www.landxml.org/schema/LandXML-1.2 \
http://www.landxml.org/schema/LandXML-1.2/LandXML-1.2.xsd\" \
version=\"1.2\" date=\"1970-01-01\" time=\"00:00:00\" readOnly=\"false\" language=\"English\">
";

const METRIC: &str = "<Units><Metric areaUnit=\"squareMeter\" linearUnit=\"meter\" volumeUnit=\"cubicMeter\" \
                      temperatureUnit=\"celsius\" pressureUnit=\"HPA\"/></Units>\n";

impl<W: Write> LandXmlSink<W> {
    /// Writes what precedes the points.
    ///
    /// # Errors
    /// Usage, if LandXML does not hold the kind of stream; or if writing fails.
    pub fn new(mut output: W, header: &Header, options: &SinkOptions) -> Result<Self> {
        expect_kind(header, "LandXML", &[Kind::TriangleMesh])?;
        let system = System::of(&header.crs);
        let unit = system.horizontal.as_ref().map(|horizontal| &horizontal.unit);
        let code = system.horizontal.as_ref().and_then(|horizontal| horizontal.code);
        let mesh = Surveyed::new(header, options)?;
        let (mut system, mut description) = (String::new(), String::new());
        match (mesh.places().origin(), code) {
            // Local coordinates are in no system.
            (Some(origin), _) => description = format!(" desc=\"origin {}\"", northing_first(origin)),
            (None, Some(code)) => system = format!("<CoordinateSystem epsgCode=\"{code}\"/>\n"),
            (None, None) => {}
        }
        write!(
            output,
            "{START}{}{system}<Application name=\"spmesh\" version=\"{}\"/>\n\
             <Surfaces>\n<Surface name=\"surface\"{description}>\n<Definition surfType=\"TIN\">\n<Pnts>\n",
            units(unit),
            env!("CARGO_PKG_VERSION")
        )
        .map_err(write_error)?;
        Ok(LandXmlSink {
            output,
            mesh,
            faces: Spool::new(options.temp_dir.as_deref())?,
            breaklines: Spool::new(options.temp_dir.as_deref())?,
            vertices: 0,
        })
    }

    fn end(&mut self) -> Result<()> {
        let Self { output, faces, breaklines, .. } = self;
        output.write_all(b"</Pnts>\n<Faces>\n").map_err(write_error)?;
        faces.copy_to(output)?;
        output.write_all(b"</Faces>\n</Definition>\n").map_err(write_error)?;
        if self.mesh.header().constrained.is_some() {
            output.write_all(b"<SourceData>\n<Breaklines>\n").map_err(write_error)?;
            breaklines.copy_to(output)?;
            output.write_all(b"</Breaklines>\n</SourceData>\n").map_err(write_error)?;
        }
        output.write_all(b"</Surface>\n</Surfaces>\n</LandXML>\n").map_err(write_error)?;
        output.flush().map_err(write_error)
    }
}

impl<W: Write> EventSink for LandXmlSink<W> {
    fn event(&mut self, event: &Event, _rows: &[u8]) -> Result<()> {
        if let Event::End(_) = event {
            return self.end();
        }
        let Some(patch) = self.mesh.event(event)? else { return Ok(()) };
        for &place in &patch.places[..patch.patch.new.len()] {
            self.vertices += 1;
            writeln!(self.output, "<P id=\"{}\">{}</P>", self.vertices, northing_first(place))
                .map_err(write_error)?;
        }
        for triangle in patch.patch.triangles() {
            let [a, b, c] = triangle.map(|local| patch.patch.id(local) + 1);
            self.faces.text(format_args!("<F>{a} {b} {c}</F>\n"))?;
        }
        for edge in &patch.edges {
            let [from, to] = patch.ends(edge).map(northing_first);
            self.breaklines.text(format_args!(
                "<Breakline brkType=\"standard\" name=\"{}\"><PntList3D>{from} {to}</PntList3D></Breakline>\n",
                edge.line
            ))?;
        }
        Ok(())
    }

    fn notices(&self) -> Vec<String> {
        let header = self.mesh.header();
        let system = System::of(&header.crs);
        let is_coded = system.horizontal.is_some_and(|horizontal| horizontal.code.is_some());
        let crs = match &header.crs {
            Crs::Unknown => None,
            _ if self.mesh.places().origin().is_some() => Some("local coordinates are in no CRS: dropped"),
            _ if is_coded => {
                Some("LandXML gets the EPSG code of x and y only: the rest of the CRS is dropped")
            }
            _ => Some("LandXML holds no CRS without an EPSG code: dropped"),
        };
        let crs = crs.map(String::from);
        crs.into_iter().chain(lost_attributes(header, "LandXML")).collect()
    }
}

fn northing_first([x, y, z]: Point) -> String {
    format!("{} {} {}", Decimal(y), Decimal(x), Decimal(z))
}

/// The units of lengths; metres if they are not known, or are none that LandXML knows.
fn units(unit: Option<&Unit>) -> String {
    let foot = match unit.and_then(|unit| unit.code) {
        Some(9002) => "foot",
        Some(9003) => "USSurveyFoot",
        _ => return METRIC.into(),
    };
    format!(
        "<Units><Imperial areaUnit=\"squareFoot\" linearUnit=\"{foot}\" volumeUnit=\"cubicFeet\" \
         temperatureUnit=\"fahrenheit\" pressureUnit=\"inHG\"/></Units>\n"
    )
}
