//! Filtrations by their definition, in rational numbers: the value of a simplex is the least power of a point
//! from its corners that is the same for all of them and no greater than that from any other point.

use super::molecules::{Record, cloud, pdb};
use crate::programs::{outcome, run};
use num_bigint::BigInt;
use spmesh_delaunay::delaunay3::{triangulate, triangulate_weighted};
use spmesh_molecules::tess3::filtration::Filtration;
use spmesh_reference::sets::Random;
use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet};

/// A quotient with a positive denominator.
#[derive(Debug, Clone)]
struct Rational(BigInt, BigInt);

impl Rational {
    fn new(numerator: BigInt, denominator: BigInt) -> Rational {
        if denominator < BigInt::ZERO {
            Rational(-numerator, -denominator)
        } else {
            Rational(numerator, denominator)
        }
    }

    fn cmp(&self, other: &Rational) -> Ordering {
        (&self.0 * &other.1).cmp(&(&other.0 * &self.1))
    }

    /// A decimal number.
    fn parse(text: &str) -> Rational {
        let (digits, exponent) = text.split_once('e').unwrap_or((text, "0"));
        let (whole, fraction) = digits.split_once('.').unwrap_or((digits, ""));
        let exponent: i32 = exponent.parse::<i32>().unwrap() - fraction.len() as i32;
        let digits: BigInt = format!("{whole}{fraction}").parse().unwrap();
        let power = BigInt::from(10).pow(exponent.unsigned_abs());
        if exponent < 0 { Rational(digits, power) } else { Rational(digits * power, BigInt::from(1)) }
    }

    /// Whether a number is no further away than `bound`, which is zero only if it must be equal.
    fn is_within(&self, bound: &Rational, number: &Rational) -> bool {
        let (denominator, difference) = (&self.1 * &number.1, &self.0 * &number.1 - &number.0 * &self.1);
        let magnitude = if difference < BigInt::ZERO { -difference } else { difference };
        magnitude * &bound.1 <= &bound.0 * denominator
    }
}

/// A point with integer coordinates and weight.
type Ball = [i64; 4];

fn determinant(rows: &[Vec<BigInt>]) -> BigInt {
    let Some((first, rest)) = rows.split_first() else { return BigInt::from(1) };
    let minor = |column: usize| -> Vec<Vec<BigInt>> {
        rest.iter().map(|row| [&row[..column], &row[column + 1..]].concat()).collect()
    };
    let term = |column: usize| &first[column] * determinant(&minor(column));
    (0..first.len()).map(|column| if column % 2 == 0 { term(column) } else { -term(column) }).sum()
}

fn dot(p: [i64; 3], q: [i64; 3]) -> i128 {
    (0..3).map(|axis| i128::from(p[axis]) * i128::from(q[axis])).sum()
}

fn minus(p: Ball, q: Ball) -> [i64; 3] {
    [0, 1, 2].map(|axis| p[axis] - q[axis])
}

/// The orthocentre of some balls in the flat of their centres, and its power: times a common denominator.
/// `None` if the flat has less dimension than it could have. By Cramer's rule for Gram's matrix.
fn orthocentre(balls: &[Ball]) -> Option<([BigInt; 3], Rational, BigInt)> {
    let a = balls[0];
    let sides: Vec<[i64; 3]> = balls[1..].iter().map(|&ball| minus(ball, a)).collect();
    let lifts = balls[1..]
        .iter()
        .zip(&sides)
        .map(|(ball, &side)| BigInt::from(dot(side, side) - i128::from(ball[3] - a[3])));
    let lifts: Vec<BigInt> = lifts.collect();
    let gram: Vec<Vec<BigInt>> =
        sides.iter().map(|&p| sides.iter().map(|&q| BigInt::from(2 * dot(p, q))).collect()).collect();
    let denominator = determinant(&gram);
    if denominator == BigInt::ZERO {
        return None;
    }
    let mut centre = a.map(|coordinate| &denominator * coordinate);
    for (column, side) in sides.iter().enumerate() {
        let mut replaced = gram.clone();
        replaced.iter_mut().zip(&lifts).for_each(|(row, lift)| row[column] = lift.clone());
        let factor = determinant(&replaced);
        (0..3).for_each(|axis| centre[axis] += &factor * side[axis]);
    }
    let centre = [0, 1, 2].map(|axis| centre[axis].clone());
    let power = power(&centre, &denominator, a);
    Some((centre, power, denominator))
}

/// The power of a point from a ball.
fn power(centre: &[BigInt; 3], denominator: &BigInt, ball: Ball) -> Rational {
    let square = (0..3).map(|axis| (&centre[axis] - denominator * ball[axis]).pow(2)).sum::<BigInt>();
    let square_of_denominator = denominator * denominator;
    Rational::new(square - &square_of_denominator * ball[3], square_of_denominator)
}

/// The value of a simplex by the definition; `None` if it has no such point. The least is at an orthocentre
/// of the simplex or of one that it is a face of.
fn value(all: &[Ball], simplex: &[usize]) -> Option<Rational> {
    let mut least: Option<Rational> = None;
    let mut supersets = vec![simplex.to_vec()];
    while let Some(members) = supersets.pop() {
        let balls: Vec<Ball> = members.iter().map(|&i| all[i]).collect();
        if members.len() < 4 {
            let last = if members.len() > simplex.len() { members[members.len() - 1] + 1 } else { 0 };
            let others = (last..all.len()).filter(|i| !simplex.contains(i));
            supersets.extend(others.map(|other| [&members[..], &[other]].concat()));
        }
        let Some((centre, own, denominator)) = orthocentre(&balls) else { continue };
        let is_free = |&ball: &Ball| power(&centre, &denominator, ball).cmp(&own).is_ge();
        if least.as_ref().is_none_or(|least| own.cmp(least).is_lt()) && all.iter().all(is_free) {
            least = Some(own);
        }
    }
    least
}

/// A line of a filtration.
struct Line {
    vertices: Vec<usize>,
    value: Rational,
    bound: Rational,
}

fn lines(text: &str) -> Vec<Line> {
    let line = |line: &str| {
        let words: Vec<&str> = line.split(' ').collect();
        let vertices: Vec<usize> =
            words[1..words.len() - 2].iter().map(|word| word.parse().unwrap()).collect();
        assert_eq!(words[0].parse::<usize>().unwrap() + 1, vertices.len(), "{line}");
        let [value, bound] = [2, 1].map(|back| Rational::parse(words[words.len() - back]));
        Line { vertices, value, bound }
    };
    text.lines().map(line).collect()
}

fn filtration(balls: &[Ball], is_weighted: bool) -> (Vec<Line>, Vec<u32>) {
    let points: Vec<[f64; 3]> = balls.iter().map(|ball| [0, 1, 2].map(|axis| ball[axis] as f64)).collect();
    let weights: Vec<f64> = balls.iter().map(|ball| ball[3] as f64).collect();
    let (mesh, weights) = match is_weighted {
        true => (triangulate_weighted(&points, &weights).unwrap(), Some(&weights[..])),
        false => (triangulate(&points).unwrap(), None),
    };
    let mut text = Vec::new();
    Filtration::new(&points, weights, &mesh).unwrap().write(&mut text, 1.0).unwrap();
    (lines(&String::from_utf8(text).unwrap()), mesh.hidden)
}

/// Compares with the definition. Returns whether a vertex has another value than its negative weight.
fn check(balls: &[Ball], is_weighted: bool) -> bool {
    let (lines, _) = filtration(balls, is_weighted);
    let exact: Vec<Rational> = lines
        .iter()
        .map(|line| {
            value(balls, &line.vertices).unwrap_or_else(|| panic!("{:?} in {balls:?}", line.vertices))
        })
        .collect();
    let mut seen = BTreeSet::new();
    for (line, exact) in lines.iter().zip(&exact) {
        assert!(line.value.is_within(&line.bound, exact), "{:?} in {balls:?}", line.vertices);
        for left_out in (0..line.vertices.len()).filter(|_| line.vertices.len() > 1) {
            let mut face = line.vertices.clone();
            face.remove(left_out);
            assert!(seen.contains(&face), "{face:?} in {balls:?}");
        }
        assert!(line.vertices.is_sorted_by(|a, b| a < b) && seen.insert(line.vertices.clone()));
    }
    for (i, pair) in lines.windows(2).enumerate() {
        let by_vertices =
            || (pair[0].vertices.len(), &pair[0].vertices).cmp(&(pair[1].vertices.len(), &pair[1].vertices));
        let order = exact[i].cmp(&exact[i + 1]).then_with(by_vertices);
        assert_eq!(order, Ordering::Less, "{:?} {:?} in {balls:?}", pair[0].vertices, pair[1].vertices);
    }
    check_is_ball(&lines, balls);
    let is_attached = |(line, exact): (&Line, &Rational)| {
        let own = Rational(BigInt::from(-balls[line.vertices[0]][3]), BigInt::from(1));
        line.vertices.len() == 1 && exact.cmp(&own).is_ne()
    };
    lines.iter().zip(&exact).any(is_attached)
}

/// Triangulations of convex sets have the Euler characteristic 1, and a facet has one or two simplices of
/// greatest dimension. All points are there but hidden ones.
fn check_is_ball(lines: &[Line], balls: &[Ball]) {
    let count = |corners: usize| lines.iter().filter(|line| line.vertices.len() == corners).count() as i64;
    assert_eq!(count(1) - count(2) + count(3) - count(4), 1, "{balls:?}");
    let greatest = (1..=4).rev().find(|&corners| count(corners) > 0).unwrap();
    let mut facets: BTreeMap<Vec<usize>, usize> = BTreeMap::new();
    for line in lines.iter().filter(|line| line.vertices.len() == greatest) {
        for i in 0..greatest {
            let facet = [&line.vertices[..i], &line.vertices[i + 1..]].concat();
            *facets.entry(facet).or_default() += 1;
        }
    }
    assert!(greatest == 1 || facets.values().all(|&simplices| simplices <= 2), "{balls:?}");
    let present = || lines.iter().filter(|line| line.vertices.len() == 1).map(|line| line.vertices[0]);
    let places: BTreeSet<[i64; 3]> = present().map(|i| minus(balls[i], [0; 4])).collect();
    assert_eq!(places.len(), present().count(), "{balls:?}");
    for missing in (0..balls.len()).filter(|&i| !places.contains(&minus(balls[i], [0; 4]))) {
        // Its cell has no interior: with a little less weight it has no cell.
        let mut finer: Vec<Ball> =
            balls.iter().map(|&[x, y, z, w]| [1000 * x, 1000 * y, 1000 * z, 1_000_000 * w]).collect();
        finer[missing][3] -= 1;
        assert!(value(&finer, &[missing]).is_none(), "{missing} in {balls:?}");
    }
}

/// Random balls in a lattice of `sides`.
fn random_balls(random: &mut Random, count: usize, sides: [i64; 3], weight_max: i64) -> Vec<Ball> {
    let mut balls = Vec::new();
    for _ in 0..count {
        let [x, y, z] = sides.map(|side| random.integer(0, side));
        balls.push([x, y, z, random.integer(0, weight_max)]);
    }
    balls
}

#[test]
fn values_and_order_are_those_of_the_definition() {
    let mut random = Random::new(11);
    for round in 0..60 {
        let side = [1, 2, 3, 1000][round % 4];
        let balls = random_balls(&mut random, 4 + round % 9, [side; 3], 0);
        check(&balls, round % 8 < 4);
    }
}

#[test]
fn weighted_values_are_those_of_the_definition() {
    let mut random = Random::new(12);
    let (mut attached, mut hidden) = (0, 0);
    for round in 0..80 {
        let (side, weight) = [(2, 2), (3, 6), (4, 12), (1000, 300_000)][round % 4];
        let balls = random_balls(&mut random, 5 + round % 8, [side; 3], weight);
        attached += usize::from(check(&balls, true));
        hidden += filtration(&balls, true).1.len();
    }
    assert!(attached > 5 && hidden > 5, "{attached} {hidden}");
}

#[test]
fn points_in_a_plane_on_a_line_and_at_one_place() {
    let mut random = Random::new(13);
    for round in 0..60 {
        let sides = [[3, 3, 0], [0, 4, 0], [0, 0, 0], [0, 3, 3], [9, 0, 5]][round % 5];
        let mut balls = random_balls(&mut random, 1 + round % 9, sides, [0, 4][round % 2]);
        if round % 3 == 0 {
            // A tilted plane.
            balls.iter_mut().for_each(|[x, y, z, _]| *z += 2 * *x - *y + 1);
        }
        check(&balls, round % 2 == 1);
    }
}

#[test]
fn congruent_simplices_have_equal_values_however_they_are_computed() {
    let corners = [[0, 0, 0], [123_457, 3_001, 20_011], [70_003, 110_017, -9_973], [31_013, 40_009, 99_991]];
    let mut balls: Vec<Ball> = Vec::new();
    for (copy, order) in (0..3).zip([[0, 1, 2, 3], [2, 0, 3, 1], [3, 2, 1, 0]]) {
        // Axes are cycled, which is a rotation; the copies are far apart.
        let turned =
            order.map(|i| [0, 1, 2].map(|axis| corners[i][(axis + copy) % 3] + 1_000_000 * copy as i64));
        balls.extend(turned.map(|[x, y, z]| [x, y, z, 0]));
    }
    check(&balls, false);
    check(&balls, true);
}

#[test]
fn values_that_differ_by_less_than_rounding_are_told_apart() {
    // The squares of these two edges are 2^80 + 1 and 2^80.
    let (near, far) = (1 << 40, 1 << 42);
    let balls = [[0, 0, 0, 0], [near, 1, 0, 0], [0, far, 0, 0], [near, far, 0, 0]];
    check(&balls, false);
    let position =
        |wanted: [usize; 2]| filtration(&balls, false).0.iter().position(|line| line.vertices == wanted);
    assert!(position([2, 3]) < position([0, 1]));
}

fn of_text(text: &str) -> String {
    let output = run("tess3", &["--filtration", "-"], text.as_bytes());
    assert!(output.status.success(), "{:?}", outcome(&output));
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn the_program_writes_squares_of_angstroms() {
    // Two unit squares of 1 Å in a row, lifted off the grid by a quarter of a step.
    let points: [[f64; 3]; 4] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 3.0, 0.0], [0.0, 0.0, 0.005]];
    let records: Vec<Record> = (1..).zip(points).map(|(serial, at)| Record::carbon(serial, at)).collect();
    let text = of_text(&pdb(&records));
    for line in ["0 3 0 0", "1 0 3 0.00000625 0", "1 0 1 0.25 0", "1 1 2 2.5 0", "2 0 1 2 2.5 0"] {
        assert!(text.lines().any(|found| found == line), "{line} in {text}");
    }
    assert!(text.ends_with("3 0 1 2 3 2.50000625 0\n"), "{text}");
}

#[test]
fn rounded_values_have_17_digits() {
    let text = of_text("0 0 0\n3 0 0\n0.1 2 0\n1 1 1e20\n1 1 -1e-9\n");
    let inexact = text.lines().filter(|line| !line.ends_with(" 0"));
    let digits =
        |word: &str| word.split('e').next().unwrap().trim_start_matches(['0', '.']).replace('.', "").len();
    let words: Vec<Vec<&str>> = inexact.map(|line| line.split(' ').collect()).collect();
    assert!(words.len() > 8 && words.iter().all(|words| digits(words[words.len() - 2]) == 17), "{text}");
}

#[test]
fn the_filtration_is_independent_of_the_order_of_atoms() {
    let atoms = cloud(60, 9_000, 21);
    let mut turned = atoms.clone();
    turned.reverse();
    let rename = |vertex: usize| atoms.len() - 1 - vertex;
    let values = |atoms: &[Record], name: &dyn Fn(usize) -> usize| -> BTreeMap<Vec<usize>, String> {
        let text = of_text(&pdb(atoms));
        let value = text.lines().map(|line| line.rsplit(' ').nth(1).unwrap().to_string());
        let mut renamed: Vec<Vec<usize>> =
            lines(&text).into_iter().map(|line| line.vertices.into_iter().map(name).collect()).collect();
        renamed.iter_mut().for_each(|vertices| vertices.sort_unstable());
        renamed.into_iter().zip(value).collect()
    };
    assert_eq!(values(&atoms, &|vertex| vertex), values(&turned, &rename));
}

#[test]
fn one_filtration_per_model_and_nothing_else_with_it() {
    let two = super::molecules::models(&[cloud(9, 9_000, 1), cloud(9, 9_000, 2)]);
    assert_eq!(outcome(&run("tess3", &["--filtration", "--model", "all", "-"], two.as_bytes())).0, Some(2));
    for other in [&["--table"][..], &["--contacts"], &["--alpha", "3"]] {
        let arguments = [&["--filtration", "-"], other].concat();
        assert_eq!(outcome(&run("tess3", &arguments, two.as_bytes())).0, Some(2), "{other:?}");
    }
}

/// Digits that are rounded up to a power of ten.
#[test]
fn values_next_to_powers_of_ten_end() {
    let text = "3\nc\nC 0 0 0\nC 1e-18 0 0\nC 1 1 1e-18\n";
    let output = crate::programs::run("tess3", &["--filtration", "-"], text.as_bytes());
    let lines = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success() && lines.lines().count() >= 5, "{lines}");
}
