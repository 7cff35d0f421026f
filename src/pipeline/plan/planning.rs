//! The plan as a file.

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

use data_encoding::HEXLOWER;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::check;
use super::files::{Naming, PlannedFile, Roots, settled};
use super::names::{json, name_nodes};
use super::node::Node;
use super::tree::{Division, Share};
use crate::reduce::Duplicates;
use spmesh_base::error::{Error, Result};
use spmesh_base::inputs;
use spmesh_base::limits::PLAN_LEN_MAX;
use spmesh_formats::source::{Description, Extent, SkippedFile, Survey};
use spmesh_stream::model::bounds::Bounds;
use spmesh_stream::model::points::Point2;
use spmesh_stream::{Coordinates, Crs, Header, Kind, PartName};

/// What a plan says of itself, so that no other JSON is taken for one.
const FORMAT: &str = "spmesh plan";

/// Version of the layout.
const VERSION: u32 = 2;

/// The extent of files that are not read for points.
const NO_POINTS: Extent = Extent { points: 0, bounds: None };

/// The grid of integer coordinates.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Grid {
    scale: [f64; 3],
    offset: [f64; 3],
}

/// A coordinate reference system: text, or the three GeoTIFF records of LAS files in hexadecimal digits.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum PlannedCrs {
    Unknown,
    Wkt(String),
    GeoKeys([String; 3]),
}

impl PlannedCrs {
    fn of(crs: &Crs) -> PlannedCrs {
        match crs {
            Crs::Unknown => PlannedCrs::Unknown,
            Crs::Wkt(text) => PlannedCrs::Wkt(text.clone()),
            Crs::GeoKeys { directory, doubles, ascii } => {
                PlannedCrs::GeoKeys([directory, doubles, ascii].map(|bytes| HEXLOWER.encode(bytes)))
            }
        }
    }

    fn crs(&self) -> Result<Crs> {
        let bytes = |text: &String| {
            HEXLOWER.decode(text.as_bytes()).map_err(|e| Error::malformed(format!("coordinate system: {e}")))
        };
        Ok(match self {
            PlannedCrs::Unknown => Crs::Unknown,
            PlannedCrs::Wkt(text) => Crs::Wkt(text.clone()),
            PlannedCrs::GeoKeys([directory, doubles, ascii]) => {
                Crs::GeoKeys { directory: bytes(directory)?, doubles: bytes(doubles)?, ascii: bytes(ascii)? }
            }
        })
    }
}

/// How to make a plan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Planning<'a> {
    /// A box is divided if more points than this are expected in it.
    pub leaf_points: u64,
    /// Arguments of `spfinalize` that say which points count, and how files are read.
    pub arguments: &'a [String],
    /// Files beside those of points that say which points count.
    pub beside: &'a [PathBuf],
    /// Which elevation survives where points coincide. In space: `First` or `Error`.
    pub duplicates: Duplicates,
    /// How files are named, and what makes them the same.
    pub naming: &'a Naming,
    /// Files that are left out, and why.
    pub skipped: &'a [SkippedFile],
}

/// A plan: the files, and the tree of nodes that triangulates them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Plan {
    format: String,
    version: u32,
    /// A hash of all else, in hexadecimal digits.
    id: String,
    /// Arguments of `spfinalize` that say which points count, and how files are read.
    pub arguments: Vec<String>,
    /// Which elevation survives where points coincide.
    pub duplicates: Duplicates,
    pub(super) dims: u8,
    /// The grid of coordinates; none if they are numbers of 64 bits in world units.
    pub(super) grid: Option<Grid>,
    pub(super) elevation: bool,
    pub(super) crs: PlannedCrs,
    /// Names of the attributes of points.
    pub attributes: Vec<String>,
    /// The number of points above which a box was divided.
    pub leaf_points: u64,
    /// Points of all files.
    pub points: u64,
    /// First and last node of each stage.
    pub stages: Vec<[u32; 2]>,
    /// Files beside those of points that say which points count, such as polygons.
    pub beside: Vec<PlannedFile>,
    /// Where the roots of files are. They are no part of the hash: a plan may move with its files.
    pub roots: Roots,
    /// Files that are left out.
    pub skipped: Vec<SkippedFile>,
    /// The nodes by number.
    pub nodes: Vec<Node>,
    /// The files, in the order in which points are read.
    pub files: Vec<PlannedFile>,
}

/// Makes a plan for surveyed files, which are at `paths`.
///
/// # Errors
/// Usage, if there would be too many nodes, a file is no regular one, or points of space are to get an
/// elevation; I/O, if a file is gone.
pub fn plan_of(survey: &Survey, paths: &[PathBuf], planning: Planning) -> Result<Plan> {
    let Description { coordinates, dims, has_elevation, ref crs, ref attributes, .. } = survey.description;
    if dims == 3 && !matches!(planning.duplicates, Duplicates::First | Duplicates::Error) {
        return Err(Error::usage("points of space have no elevation: --duplicates first or error"));
    }
    let naming = Naming { roots: absolute(&planning.naming.roots)?, ..planning.naming.clone() };
    let planned = |path: &PathBuf, extent: &Extent| PlannedFile::new(path, extent, &naming);
    let pairs = paths.iter().zip(&survey.extents);
    let files = pairs.map(|(path, extent)| planned(path, extent)).collect::<Result<Vec<_>>>()?;
    let mut names = HashSet::new();
    if let Some(file) = files.iter().find(|file| !names.insert((&file.root, &file.path))) {
        return Err(Error::usage("is given twice").of_input(file.name()));
    }
    let shares: Vec<Share> = (0..)
        .zip(&survey.extents)
        .filter_map(|(file, extent)| Some(Share { file, points: extent.points, bounds: extent.bounds? }))
        .collect();
    let grid = match coordinates {
        Coordinates::F64 => None,
        Coordinates::I32 { scale, offset } => Some(Grid { scale, offset }),
    };
    let division =
        Division { dims: usize::from(dims), leaf_points: planning.leaf_points, are_whole: grid.is_some() };
    let nodes = division.nodes(&shares)?;
    let mut plan = Plan {
        format: FORMAT.to_string(),
        version: VERSION,
        id: String::new(),
        arguments: planning.arguments.to_vec(),
        duplicates: planning.duplicates,
        dims,
        grid,
        elevation: has_elevation,
        crs: PlannedCrs::of(crs),
        attributes: attributes.iter().map(|attribute| attribute.name.clone()).collect(),
        leaf_points: planning.leaf_points,
        points: files.iter().map(|file| file.points).sum(),
        stages: stages_of(&nodes),
        nodes,
        beside: planning.beside.iter().map(|path| planned(path, &NO_POINTS)).collect::<Result<_>>()?,
        roots: naming.roots.clone(),
        skipped: planning.skipped.to_vec(),
        files,
    };
    name_nodes(&mut plan)?;
    plan.id = plan.hash()?;
    Ok(plan)
}

fn absolute(roots: &Roots) -> Result<Roots> {
    let absolute = |(name, folder): (&String, &PathBuf)| {
        let finding = |e| Error::io("finding", e).of_input(folder.display().to_string());
        Ok((name.clone(), settled(folder).map_err(finding)?))
    };
    roots.iter().map(absolute).collect()
}

/// A hash of bytes, in hexadecimal digits.
pub(super) fn hash_of(bytes: &[u8]) -> String {
    short(&Sha256::digest(bytes).into())
}

/// The first bytes of a hash, in hexadecimal digits.
pub(super) fn short(digest: &[u8; 32]) -> String {
    HEXLOWER.encode(&digest[..8])
}

/// First and last number of each stage.
fn stages_of(nodes: &[Node]) -> Vec<[u32; 2]> {
    let mut stages: Vec<[u32; 2]> = Vec::new();
    for node in nodes {
        match stages.get_mut(node.stage as usize) {
            Some(stage) => stage[1] = node.number,
            None => stages.push([node.number; 2]),
        }
    }
    stages
}

impl Plan {
    /// Reads a plan.
    ///
    /// # Errors
    /// I/O, if the file cannot be read; malformed, if it is no plan, or was changed by hand; unsupported, if
    /// its version is another one.
    pub fn read(path: &Path) -> Result<Plan> {
        let named = |error: Error| error.of_input(path.display().to_string());
        let text = inputs::read(path, "a plan of", PLAN_LEN_MAX).map_err(named)?;
        Plan::parse(&text).map_err(named)
    }

    /// Says where roots are now.
    ///
    /// # Errors
    /// Usage, if the plan has no root of this name.
    pub fn move_roots(&mut self, roots: Roots) -> Result<()> {
        for (name, folder) in absolute(&roots)? {
            match self.roots.get_mut(&name) {
                Some(place) => *place = folder,
                None => return Err(Error::usage(format!("the plan has no root {name:?}"))),
            }
        }
        Ok(())
    }

    /// Takes note that the files of the plan are inputs, whichever node reads them.
    ///
    /// # Errors
    /// Usage, if one of them is an output of this run.
    pub fn note_files(&self) -> Result<()> {
        self.all_files().try_for_each(|file| inputs::note(&file.path(&self.roots)))
    }

    /// Checks that all files are as they were when the plan was made.
    ///
    /// # Errors
    /// I/O, if one is gone; usage, if one has changed.
    pub fn check_files(&self) -> Result<()> {
        self.all_files().try_for_each(|file| file.check(&self.roots))
    }

    fn all_files(&self) -> impl Iterator<Item = &PlannedFile> {
        self.files.iter().chain(&self.beside)
    }

    fn parse(text: &[u8]) -> Result<Plan> {
        /// What all versions have.
        #[derive(Deserialize)]
        struct Head {
            format: String,
            version: u32,
        }
        let not_one =
            |e: serde_json::Error| Error::malformed(format!("this is no plan of spfinalize --plan: {e}"));
        let Head { format, version } = serde_json::from_slice(text).map_err(not_one)?;
        if format != FORMAT {
            return Err(Error::malformed(format!(
                "this is {format:?}, expected a plan of spfinalize --plan"
            )));
        }
        if version != VERSION {
            return Err(Error::unsupported(format!(
                "version {version} of a plan; this program reads version {VERSION}: plan again"
            )));
        }
        let plan: Plan = serde_json::from_slice(text).map_err(not_one)?;
        if plan.hash()? != plan.id {
            return Err(Error::malformed("the plan was changed since it was made: plan again"));
        }
        check::check(&plan)?;
        Ok(plan)
    }

    /// The plan as JSON, one file or node in each line.
    ///
    /// # Errors
    /// If it cannot be written as JSON.
    pub fn to_json(&self) -> Result<String> {
        let text = |e: serde_json::Error| Error::malformed(format!("the plan cannot be written: {e}"));
        let head = Plan { nodes: Vec::new(), files: Vec::new(), ..self.clone() };
        let head = serde_json::to_string(&head).map_err(text)?;
        let lines = |items: Vec<std::result::Result<String, serde_json::Error>>| {
            let lines = items.into_iter().collect::<std::result::Result<Vec<_>, _>>().map_err(text)?;
            Ok::<String, Error>(lines.join(",\n"))
        };
        let nodes = lines(self.nodes.iter().map(serde_json::to_string).collect())?;
        let files = lines(self.files.iter().map(serde_json::to_string).collect())?;
        let empty = "\"nodes\":[],\"files\":[]}";
        let head = head.strip_suffix(empty).unwrap_or(&head);
        Ok(format!("{head}\"nodes\":[\n{nodes}\n],\n\"files\":[\n{files}\n]}}\n"))
    }

    /// The hash of everything but the hash, and where roots are.
    fn hash(&self) -> Result<String> {
        let bare = Plan { id: String::new(), roots: Roots::new(), ..self.clone() };
        Ok(hash_of(&json(&bare)?))
    }

    /// Dimensions of the geometry: 2 or 3.
    pub fn dims(&self) -> u8 {
        self.dims
    }

    /// The encoding of all coordinates.
    pub fn coordinates(&self) -> Coordinates {
        match self.grid {
            None => Coordinates::F64,
            Some(Grid { scale, offset }) => Coordinates::I32 { scale, offset },
        }
    }

    /// Node `number`.
    ///
    /// # Errors
    /// Usage, if there is none.
    pub fn node(&self, number: u32) -> Result<&Node> {
        let last = self.nodes.len().saturating_sub(1);
        self.nodes
            .get(number as usize)
            .ok_or_else(|| Error::usage(format!("there is no node {number}: the plan has nodes 0 to {last}")))
    }

    /// The name of a node's part.
    pub fn part(&self, node: &Node) -> PartName {
        PartName { node: PartName::parse_node(&node.name).unwrap_or_default(), below: node.below }
    }

    /// The header of streams of points without attributes.
    ///
    /// # Errors
    /// Malformed, if the coordinate system of the plan is damaged.
    pub fn header(&self, kind: Kind) -> Result<Header> {
        let mut header = Header::new(kind, self.coordinates(), self.dims, self.elevation);
        header.crs = self.crs.crs()?;
        Ok(header)
    }

    /// Whether there is a leaf at a place, in stored coordinates, into which files reach.
    pub fn has_files_at(&self, [x, y]: Point2) -> bool {
        let has = |node: &&Node| node.region.region().contains([x, y, 0.0]);
        let mut node = self.nodes.last().filter(has);
        while let Some(inner) = node.filter(|node| !node.children.is_empty()) {
            let mut children = inner.children.iter().filter_map(|&child| self.nodes.get(child as usize));
            node = children.find(has);
        }
        node.is_some_and(|leaf| !leaf.files.is_empty())
    }

    /// The files that reach into a leaf.
    pub fn files_of(&self, node: &Node) -> Vec<&PlannedFile> {
        node.files.iter().filter_map(|&file| self.files.get(file as usize)).collect()
    }

    /// The file of the plan at each path, whether or not it is as it was; `None` if the plan has none.
    ///
    /// # Errors
    /// I/O, if a path leads through a folder that is not there.
    pub fn files_at(&self, paths: &[PathBuf]) -> Result<Vec<Option<&PlannedFile>>> {
        let place = |path: &PathBuf| {
            settled(path).map_err(|e| Error::io("finding", e).of_input(path.display().to_string()))
        };
        let places = paths.iter().map(place).collect::<Result<Vec<_>>>()?;
        // A plan may have a million files.
        let wanted: HashSet<&PathBuf> = places.iter().collect();
        let files = self.files.iter().map(|file| (file.path(&self.roots), file));
        let found: HashMap<PathBuf, &PlannedFile> = files.filter(|(path, _)| wanted.contains(path)).collect();
        Ok(places.iter().map(|place| found.get(place).copied()).collect())
    }

    /// The files whose boxes begin in a leaf: each file with points begins in one leaf.
    pub fn files_from<'p>(&'p self, leaf: &'p Node) -> impl Iterator<Item = &'p PlannedFile> {
        let region = leaf.region.region();
        self.files_of(leaf).into_iter().filter(move |file| file.min.is_some_and(|min| region.contains(min)))
    }

    /// The box of the world of a file, as wide as roundings may make it; `None` without points.
    pub fn in_world(&self, file: &PlannedFile) -> Option<Bounds> {
        let (coordinates, Bounds { min, max }) = (self.coordinates(), file.bounds()?);
        Some(coordinates.widened(&Bounds { min: coordinates.to_world(min), max: coordinates.to_world(max) }))
    }

    /// The nodes in an order in which each comes behind its children, and few wait for their parent.
    pub fn upwards(&self) -> Vec<u32> {
        let mut order = Vec::with_capacity(self.nodes.len());
        let mut waiting: Vec<(u32, bool)> =
            self.nodes.last().map(|root| (root.number, false)).into_iter().collect();
        while let Some((number, is_expanded)) = waiting.pop() {
            let children = self.nodes.get(number as usize).map_or(&[][..], |node| &node.children);
            if is_expanded || children.is_empty() {
                order.push(number);
            } else {
                waiting.push((number, true));
                waiting.extend(children.iter().rev().map(|&child| (child, false)));
            }
        }
        order
    }
}
