//! Writes glTF 2.0 in its binary form, GLB.
//!
//! Source: Khronos Group, "glTF 2.0 Specification", sections 3.6 (buffers), 3.7 (meshes) and 4 (GLB). Axes
//! are those of glTF: x is x, y is up, z is -y.

use std::io::Write;
use std::path::Path;

use serde_json::{Value, json};

use crate::crs::System;
use crate::sink::floats::Floats;
use crate::sink::spool::{MeshSpool, place_of};
use crate::sink::{EventSink, expect_kind, lost_attributes, lost_of_header, write_error};
use spmesh_base::error::{Error, Result};
use spmesh_stream::model::bounds::Point;
use spmesh_stream::{Event, Header, Kind, Totals};

/// The numbers of glTF for types and targets.
const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;
const VERTEX_BUFFER: u32 = 34962;
const INDEX_BUFFER: u32 = 34963;
const POINTS: u32 = 0;
const TRIANGLES: u32 = 4;

const VERTEX_LEN: u64 = 12;
const INDEX_LEN: u64 = 4;

/// What a GLB holds.
#[derive(Debug, Clone, PartialEq)]
pub struct Glb {
    /// Number of vertices.
    pub vertices: u64,
    /// Number of corners of triangles; the vertices are drawn as points if there are none.
    pub corners: u64,
    /// The box of the positions, in the axes of glTF.
    pub min: [f32; 3],
    /// The other corner of the box.
    pub max: [f32; 3],
    /// Where the origin of the positions is, in the axes of glTF.
    pub translation: Point,
    /// Whether normals follow the positions.
    pub has_normals: bool,
    /// What the node says beside.
    pub extras: Value,
}

/// A place in the axes of glTF.
pub fn upright<T: std::ops::Neg<Output = T> + Copy>([x, y, z]: [T; 3]) -> [T; 3] {
    [x, z, -y]
}

impl Glb {
    /// Bytes of the binary chunk.
    fn binary_len(&self) -> u64 {
        let per_vertex = if self.has_normals { 2 * VERTEX_LEN } else { VERTEX_LEN };
        self.vertices * per_vertex + self.corners * INDEX_LEN
    }

    /// Writes what precedes the positions, three f32 each. Normals, if there are any, and a u32 per corner
    /// follow, all little-endian.
    ///
    /// # Errors
    /// Usage, if the file becomes too long; or if writing fails.
    pub fn start(&self, output: &mut impl Write) -> Result<()> {
        let mut json = self.json().to_string().into_bytes();
        json.resize(json.len().next_multiple_of(4), b' ');
        let binary_len = self.binary_len();
        let binary_chunk = if binary_len > 0 { 8 + binary_len } else { 0 };
        let len = u32::try_from(20 + json.len() as u64 + binary_chunk).map_err(|_| too_long())?;
        let mut head = [&b"glTF"[..], &2u32.to_le_bytes(), &len.to_le_bytes()].concat();
        head.extend((json.len() as u32).to_le_bytes());
        head.extend(b"JSON");
        head.append(&mut json);
        if binary_len > 0 {
            head.extend((binary_len as u32).to_le_bytes());
            head.extend(b"BIN\0");
        }
        output.write_all(&head).map_err(write_error)
    }

    fn json(&self) -> Value {
        let asset = json!({"version": "2.0", "generator": "spmesh"});
        // glTF has no empty arrays.
        if self.vertices == 0 {
            return json!({"asset": asset, "scene": 0, "scenes": [{}]});
        }
        let positions = VERTEX_LEN * self.vertices;
        let view = |start: u64, len: u64, target: u32| json!({"buffer": 0, "byteOffset": start, "byteLength": len, "target": target});
        let mut views = vec![view(0, positions, VERTEX_BUFFER)];
        let [min, max] = [self.min, self.max].map(|corner| corner.map(f64::from));
        let vector = json!({"componentType": FLOAT, "count": self.vertices, "type": "VEC3"});
        let mut accessors = vec![vector.clone()];
        accessors[0]["bufferView"] = json!(0);
        (accessors[0]["min"], accessors[0]["max"]) = (json!(min), json!(max));
        let mut primitive = json!({"attributes": {"POSITION": 0}, "mode": POINTS});
        if self.has_normals {
            primitive["attributes"]["NORMAL"] = json!(1);
            views.push(view(positions, positions, VERTEX_BUFFER));
            accessors.push(vector);
            accessors[1]["bufferView"] = json!(1);
        }
        if self.corners > 0 {
            let number = views.len();
            (primitive["mode"], primitive["indices"]) = (json!(TRIANGLES), json!(number));
            let indices = INDEX_LEN * self.corners;
            views.push(view(self.binary_len() - indices, indices, INDEX_BUFFER));
            accessors.push(json!({
                "bufferView": number, "componentType": UNSIGNED_INT, "count": self.corners, "type": "SCALAR"
            }));
        }
        let mut node = json!({"mesh": 0});
        if self.translation != [0.0; 3] {
            node["translation"] = json!(self.translation);
        }
        if !self.extras.is_null() {
            node["extras"] = self.extras.clone();
        }
        json!({
            "asset": asset,
            "scene": 0,
            "scenes": [{"nodes": [0]}],
            "nodes": [node],
            "meshes": [{"primitives": [primitive]}],
            "buffers": [{"byteLength": self.binary_len()}],
            "bufferViews": views,
            "accessors": accessors,
        })
    }
}

fn too_long() -> Error {
    Error::usage("the mesh needs more than the 4 GiB of a GLB: make it smaller with spsimplify, or use PLY")
}

/// Writes points or a triangle mesh as GLB. Positions are differences from a local origin, where that helps;
/// the node that holds the mesh is translated by it, and states it in its extras.
///
/// The format states its counts first, so everything waits in unnamed temporary files until the end. Memory:
/// buffers only.
pub struct GlbSink<W> {
    output: W,
    mesh: MeshSpool,
    len: u64,
    rounding: Option<String>,
}

impl<W: Write> GlbSink<W> {
    /// Opens the temporary files, in `temp_dir` or the system's folder for them.
    ///
    /// # Errors
    /// Usage, if the format does not hold the kind of stream; I/O, if there is no room for temporary files.
    pub fn new(output: W, header: &Header, temp_dir: Option<&Path>) -> Result<Self> {
        expect_kind(header, "glTF", &[Kind::Points, Kind::TriangleMesh])?;
        Ok(GlbSink { output, mesh: MeshSpool::new(header, temp_dir)?, len: 0, rounding: None })
    }

    fn end(&mut self, totals: &Totals) -> Result<()> {
        let is_mesh = self.mesh.header().kind == Kind::TriangleMesh;
        let vertices = if is_mesh { totals.vertices } else { totals.points };
        let mut glb = Glb {
            vertices,
            corners: 3 * totals.simplices,
            min: [0.0; 3],
            max: [0.0; 3],
            translation: [0.0; 3],
            has_normals: false,
            extras: Value::Null,
        };
        let Some(bounds) = &self.mesh.bounds else {
            glb.start(&mut self.output)?;
            return self.output.flush().map_err(write_error);
        };
        let floats = Floats::of_box(bounds)?;
        let [[x, y, z], [x_max, y_max, z_max]] = [floats.min, floats.max];
        (glb.min, glb.max) = ([x, z, -y_max], [x_max, z_max, -y]);
        glb.translation = upright(floats.origin).map(|x| x + 0.0);
        glb.extras = json!({"origin": floats.origin, "crs": System::of(&self.mesh.header().crs).name()});
        glb.start(&mut self.output)?;
        let mut places = self.mesh.vertices.records::<24>()?;
        for _ in 0..vertices {
            let place = floats.of(place_of(&places.next()?));
            write(&mut self.output, upright(place).map(f32::to_le_bytes).as_flattened())?;
        }
        let mut corners = self.mesh.corners.records::<8>()?;
        for _ in 0..glb.corners {
            // The length limits ids to 32 bits.
            write(&mut self.output, &corners.next()?[..4])?;
        }
        self.rounding = Some(floats.notice("glTF"));
        self.output.flush().map_err(write_error)
    }
}

fn write(output: &mut impl Write, bytes: &[u8]) -> Result<()> {
    output.write_all(bytes).map_err(write_error)
}

impl<W: Write> EventSink for GlbSink<W> {
    fn event(&mut self, event: &Event, _rows: &[u8]) -> Result<()> {
        self.len += match event {
            Event::End(totals) => return self.end(totals),
            Event::Points(points) => VERTEX_LEN * points.len() as u64,
            Event::Patch(patch) => {
                VERTEX_LEN * patch.new.len() as u64 + INDEX_LEN * patch.simplices.len() as u64
            }
            _ => 0,
        };
        if self.len > u64::from(u32::MAX) {
            return Err(too_long());
        }
        self.mesh.event(event, &[])
    }

    fn notices(&self) -> Vec<String> {
        let header = self.mesh.header();
        let unit = System::of(&header.crs).horizontal.map(|horizontal| horizontal.unit);
        let unit = unit.filter(|unit| unit.size != 1.0);
        let mut notices = lost_of_header(header, "glTF");
        notices.extend(lost_attributes(header, "glTF"));
        notices
            .extend(unit.map(|unit| format!("glTF is in metres, but x and y are in the unit {}", unit.name)));
        notices.extend(self.rounding.clone());
        notices
    }
}
