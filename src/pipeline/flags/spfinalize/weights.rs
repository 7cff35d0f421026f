//! Flags that give points weights.

use std::path::Path;
use std::sync::Arc;

use clap::Args;

use crate::finalize::WeightSource;
use spmesh_base::error::Result;
use spmesh_formats::molecules::Radii;
use spmesh_formats::source::AttributeChoice;

/// The attribute that atoms with radii have.
const RADIUS: &str = "radius";

/// Weights of points of space.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Weights, for spdelaunay3d --weights")]
pub(super) struct WeightFlags {
    /// Weight = radius squared: the name of an attribute with radii, such as radius of a PLY file; for atoms,
    /// a table (protor, bondi, united, charmm) or a file of radii, as in tess3
    #[arg(long, value_name = "NAME|FILE", requires = "octree")]
    radii: Option<String>,

    /// Radius of a probe that is added to each radius, in units of the coordinates, for atoms Å [default: 0]
    #[arg(long, value_name = "RADIUS", requires = "radii", conflicts_with = "weights")]
    #[arg(allow_hyphen_values = true, value_parser = parse_probe)]
    probe: Option<f64>,

    /// The name of an attribute that holds the weights: for balls, the squares of radii
    #[arg(
        long,
        value_name = "NAME",
        requires = "octree",
        conflicts_with = "radii",
        allow_hyphen_values = true
    )]
    weights: Option<String>,
}

/// What points are weighed by.
pub(super) struct Weighing {
    pub(super) source: WeightSource,
    /// The radii of atoms, if they are looked up.
    pub(super) radii: Option<Arc<Radii>>,
}

impl WeightFlags {
    /// What points are weighed by, if they are.
    pub(super) fn load(&self) -> Result<Option<Weighing>> {
        if let Some(attribute) = &self.weights {
            return Ok(Some(Weighing { source: WeightSource::Weights(attribute.clone()), radii: None }));
        }
        let Some(name) = &self.radii else { return Ok(None) };
        let is_table = Radii::named(name).is_some() || Path::new(name).exists();
        let radii = is_table.then(|| Radii::load(name)).transpose()?.map(|loaded| Arc::new(loaded.radii));
        let attribute = if is_table { RADIUS.to_string() } else { name.clone() };
        let source = WeightSource::Radii { attribute, probe: self.probe.unwrap_or(0.0) };
        Ok(Some(Weighing { source, radii }))
    }

    /// The file of radii, if there is one.
    pub(super) fn file(&self) -> Option<&Path> {
        let file = self.radii.as_deref().filter(|name| Radii::named(name).is_none()).map(Path::new)?;
        file.exists().then_some(file)
    }
}

impl Weighing {
    /// The attributes to read: those that were chosen, and that of the weights.
    pub(super) fn with_own(&self, chosen: &[String]) -> AttributeChoice {
        match AttributeChoice::of_names(chosen) {
            AttributeChoice::All => AttributeChoice::All,
            AttributeChoice::None => AttributeChoice::Named(vec![self.name()]),
            AttributeChoice::Named(mut names) => {
                if !names.contains(&self.name()) {
                    names.push(self.name());
                }
                AttributeChoice::Named(names)
            }
        }
    }

    fn name(&self) -> String {
        self.source.attribute().to_string()
    }
}

fn parse_probe(text: &str) -> std::result::Result<f64, String> {
    match text.parse::<f64>() {
        Ok(probe) if probe.is_finite() && probe >= 0.0 => Ok(probe),
        _ => Err("expected a length from 0 on".into()),
    }
}
