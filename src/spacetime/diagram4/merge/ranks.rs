//! Sorts short lists without branches: most cells have five to sixteen vertices, in an order that no
//! processor predicts.

/// Sorts distinct numbers below 2^31, the faster the fewer there are.
#[inline(always)]
pub fn sort_distinct(numbers: &mut [u32]) {
    match numbers.len() {
        0..=8 => by_ranks::<8>(numbers),
        9..=16 => by_ranks::<16>(numbers),
        _ => numbers.sort_unstable(),
    }
}

/// Moves each number to the place that is the count of lesser ones, in up to `N` numbers; `N` is a power of
/// two.
#[inline(always)]
fn by_ranks<const N: usize>(numbers: &mut [u32]) {
    let mut padded = [i32::MAX; N];
    for (place, &number) in padded.iter_mut().zip(&*numbers) {
        *place = number as i32;
    }
    let mut ranks = [0; N];
    for other in padded {
        for (rank, number) in ranks.iter_mut().zip(padded) {
            *rank += i32::from(other < number);
        }
    }
    let mut sorted = [0; N];
    for (&number, rank) in numbers.iter().zip(ranks) {
        sorted[rank as usize & (N - 1)] = number;
    }
    numbers.copy_from_slice(&sorted[..numbers.len()]);
}

#[cfg(test)]
mod tests {
    use super::*;
    use spmesh_base::random::Random;

    #[test]
    fn lists_of_all_lengths_are_sorted() {
        let mut random = Random::new(1);
        for length in 0..40 {
            for _ in 0..20 {
                let mut numbers: Vec<u32> =
                    (0..length).map(|i| i * 50_000_000 + random.below(1 << 20) as u32).collect();
                let expected = numbers.clone();
                random.shuffle(&mut numbers);
                sort_distinct(&mut numbers);
                assert_eq!(numbers, expected);
            }
        }
    }
}
