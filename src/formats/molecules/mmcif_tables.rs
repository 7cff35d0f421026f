//! The small categories of mmCIF that tell of the molecules, beside those of the atoms.

use crate::molecules::assemblies::{Generator, Operator};
use crate::molecules::builder::StructureBuilder;
use crate::molecules::classes::Entity;
use crate::molecules::mmcif::{parse, without_uncertainty};
use crate::molecules::motion::Motion;
use crate::molecules::periodic_box::PeriodicBox;

/// A category.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Category {
    Entity,
    EntityPolymer,
    Subchain,
    Generator,
    Operator,
    UnitCell,
    SpaceGroup,
}

/// The categories: the start of their tags, and the items that are used.
const CATEGORIES: [(Category, &str, &[&str]); 7] = [
    (Category::Entity, "_entity.", &["id", "type"]),
    (Category::EntityPolymer, "_entity_poly.", &["entity_id"]),
    (Category::Subchain, "_struct_asym.", &["id", "entity_id"]),
    (Category::Generator, "_pdbx_struct_assembly_gen.", &["assembly_id", "oper_expression", "asym_id_list"]),
    (
        Category::Operator,
        "_pdbx_struct_oper_list.",
        &[
            "id",
            "matrix[1][1]",
            "matrix[1][2]",
            "matrix[1][3]",
            "vector[1]",
            "matrix[2][1]",
            "matrix[2][2]",
            "matrix[2][3]",
            "vector[2]",
            "matrix[3][1]",
            "matrix[3][2]",
            "matrix[3][3]",
            "vector[3]",
        ],
    ),
    (
        Category::UnitCell,
        "_cell.",
        &["length_a", "length_b", "length_c", "angle_alpha", "angle_beta", "angle_gamma"],
    ),
    (Category::SpaceGroup, "_symmetry.", &["space_group_name_H-M"]),
];

/// Category and item of a tag, as indices into [`CATEGORIES`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Column {
    category: usize,
    item: usize,
}

/// The column of a tag, if that is used.
pub(crate) fn column(tag: &[u8]) -> Option<Column> {
    let of_category = |category: usize| {
        let (_, start, items) = CATEGORIES[category];
        let (found, name) = tag.split_at_checked(start.len())?;
        let item = items.iter().position(|item| name.eq_ignore_ascii_case(item.as_bytes()))?;
        found.eq_ignore_ascii_case(start.as_bytes()).then_some(Column { category, item })
    };
    (0..CATEGORIES.len()).find_map(of_category)
}

/// The values of one row; empty if not stated.
type Row = Vec<String>;

/// The rows of the categories in one data block.
#[derive(Debug, Default)]
pub(crate) struct Tables {
    rows: [Vec<Row>; CATEGORIES.len()],
}

impl Tables {
    /// Starts a row of the category of `column`.
    pub(crate) fn start_row(&mut self, column: Column) {
        let items = CATEGORIES[column.category].2.len();
        self.rows[column.category].push(vec![String::new(); items]);
    }

    /// Sets a value in the last row of its category, which it starts if there is none.
    pub(crate) fn set(&mut self, column: Column, value: &[u8]) {
        if self.rows[column.category].is_empty() {
            self.start_row(column);
        }
        let row = self.rows[column.category].last_mut().expect("there is a row now");
        row[column.item] = String::from_utf8_lossy(value).trim().to_string();
    }

    /// Gives all rows to the structure.
    pub(crate) fn give(self, builder: &mut StructureBuilder) {
        for ((category, ..), rows) in CATEGORIES.into_iter().zip(self.rows) {
            rows.into_iter().for_each(|row| give_row(category, &row, builder));
        }
    }
}

fn give_row(category: Category, row: &Row, builder: &mut StructureBuilder) {
    match category {
        Category::Entity => {
            let entity = match &row[1] {
                kind if kind.eq_ignore_ascii_case("polymer") => Entity::Polymer,
                kind if kind.eq_ignore_ascii_case("water") => Entity::Water,
                _ => Entity::Other,
            };
            let name = builder.intern(&row[0]);
            builder.annotations.entities.insert(name, entity);
        }
        Category::EntityPolymer => {
            let name = builder.intern(&row[0]);
            builder.annotations.entities.insert(name, Entity::Polymer);
        }
        Category::Subchain => {
            let (subchain, entity) = (builder.intern(&row[0]), builder.intern(&row[1]));
            builder.annotations.entity_of.insert(subchain, entity);
        }
        Category::Generator => {
            let subchains = row[2].split(',').map(str::trim).filter(|name| !name.is_empty());
            let subchains = subchains.map(|name| builder.intern(name)).collect();
            let (assembly, expression) = (row[0].clone(), row[1].clone());
            builder.assemblies.generators.push(Generator { assembly, subchains, expression });
        }
        Category::Operator => {
            let motion = Motion::parse(&row[1..]);
            builder.assemblies.operators.push(Operator { name: row[0].clone(), motion });
        }
        Category::UnitCell => {
            let number = |place: usize| {
                let value = without_uncertainty(row[place].as_bytes());
                parse::<f64>(value).unwrap_or(f64::NAN)
            };
            let is_stated = row[..3].iter().any(|length| !length.is_empty());
            let stated = PeriodicBox::of_unit_cell(std::array::from_fn(number)).filter(|_| is_stated);
            builder.set_box_of(true, stated);
        }
        Category::SpaceGroup => builder.set_space_group(&row[0]),
    }
}
