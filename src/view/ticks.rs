//! Round numbers for legends and scale bars, and the format of numbers.

/// Powers of ten of numbers that are written without an exponent.
const PLAIN: std::ops::RangeInclusive<i32> = -6..=7;

/// The greatest of 1, 2 and 5 times a power of ten that is at most a number.
///
/// Domain: positive normal numbers.
pub(super) fn round_below(number: f64) -> f64 {
    rounds_near(number).filter(|&round| round <= number).fold(f64::MIN_POSITIVE, f64::max)
}

/// 1, 2 and 5 times powers of ten around a number.
fn rounds_near(number: f64) -> impl Iterator<Item = f64> {
    let power = number.log10().floor() as i32;
    (power - 1..=power + 1).flat_map(|power| [1.0, 2.0, 5.0].map(|digit| times(digit, power)))
}

/// A digit times a power of ten, rounded once where the power is exact.
fn times(digit: f64, power: i32) -> f64 {
    if (-22..0).contains(&power) { digit / 10f64.powi(-power) } else { digit * 10f64.powi(power) }
}

/// Multiples of a round step within a range, at most one more than `count`, and the step.
pub(super) fn ticks([low, high]: [f64; 2], count: usize) -> (Vec<f64>, f64) {
    let step = round_above((high - low) / (count as f64 + 0.5));
    let [first, last] = [(low / step).ceil(), (high / step).floor()];
    // Return only the ends if rounding swallows the step or no multiple lies between them.
    let is_fine = step.is_normal() && last >= first && last - first <= 2.0 * count as f64 && low + step > low;
    if !is_fine {
        return (if low < high { vec![low, high] } else { vec![low] }, high - low);
    }
    ((0..=(last - first) as u32).map(|at| (first + f64::from(at)) * step).collect(), step)
}

/// The least of 1, 2 and 5 times a power of ten that is at least a number; zero, if the number is not
/// positive and normal.
fn round_above(number: f64) -> f64 {
    if !(number.is_normal() && number > 0.0) {
        return 0.0;
    }
    rounds_near(number).find(|&round| round >= number).unwrap_or(0.0)
}

/// A number with as many decimals as multiples of a step have.
pub(super) fn number(value: f64, step: f64) -> String {
    let power = |number: f64| if number == 0.0 { 0 } else { number.abs().log10().floor() as i32 };
    let (size, fine) = (power(value), if step.is_normal() { power(step) } else { power(value) - 5 });
    if !PLAIN.contains(&size) {
        let digits = (size - fine).clamp(0, 5) as usize;
        return format!("{value:.digits$e}");
    }
    let text = format!("{value:.*}", (-fine).clamp(0, 12) as usize);
    // No minus sign on a negative number that rounds to zero.
    if text.trim_start_matches(['-', '0', '.']).is_empty() { text.replace('-', "") } else { text }
}

/// A count, with commas between groups of three digits.
pub(super) fn count(count: u64) -> String {
    let digits = count.to_string();
    let mut text = String::new();
    for (place, digit) in digits.chars().enumerate() {
        if place > 0 && (digits.len() - place).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// A count with the word for the counted items, in the singular or the plural.
pub(super) fn counted(number: u64, one: &str, many: &str) -> String {
    format!("{} {}", count(number), if number == 1 { one } else { many })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn round_numbers_are_below_and_near() {
        for (number, round) in [(1.0, 1.0), (1.99, 1.0), (2.0, 2.0), (4.9e-7, 2e-7), (0.5, 0.5), (7e20, 5e20)]
        {
            assert_eq!(round_below(number), round);
        }
        for power in -300..300 {
            let number = 1.7 * 10f64.powi(power);
            assert!(round_below(number) <= number && round_below(number) * 2.0 >= number * 0.99);
        }
    }

    #[test]
    fn ticks_are_in_their_range() {
        assert_eq!(ticks([0.0, 10.0], 5), (vec![0.0, 2.0, 4.0, 6.0, 8.0, 10.0], 2.0));
        assert_eq!(ticks([-1.3, 1.2], 5).0, [-1.0, -0.5, 0.0, 0.5, 1.0]);
        assert_eq!(ticks([0.0, 24.0], 5).0, [0.0, 5.0, 10.0, 15.0, 20.0]);
        assert_eq!(ticks([3.0, 3.0], 5).0, [3.0]);
        for range in [[1e300, 1.7e300], [-1e-300, 1e-300], [1e15, 1e15 + 1.0], [0.0, 5e-324], [-1e308, 1e308]]
        {
            let (found, _) = ticks(range, 5);
            assert!(!found.is_empty() && found.len() <= 11, "{range:?}: {found:?}");
            assert!(found.iter().all(|at| (range[0]..=range[1]).contains(at)), "{range:?}: {found:?}");
        }
    }

    #[test]
    fn numbers_have_the_decimals_of_their_step() {
        let texts = [number(0.5, 0.5), number(2.0, 0.5), number(-0.0, 1.0), number(1500.0, 500.0)];
        assert_eq!(texts, ["0.5", "2.0", "0", "1500"]);
        assert_eq!([number(2e9, 1e9), number(2.5e-9, 5e-10)], ["2e9", "2.5e-9"]);
        assert_eq!([count(7), count(1000), count(1_234_567)], ["7", "1,000", "1,234,567"]);
        assert_eq!([counted(1, "point", "points"), counted(0, "point", "points")], ["1 point", "0 points"]);
    }
}
