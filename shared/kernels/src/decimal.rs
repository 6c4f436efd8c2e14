//! Numbers as people and programs write them. The library's own reader brings tables and whole numbers of any length, which a
//! page would have to fetch: 12 KB of a module.

/// Digits that are looked at: what follows changes nothing that anybody could see.
const DIGITS: u32 = 19;

/// The number that `text` is, such as `-12.5`, `.5` or `1e-4`: the nearest of 64 bits where it has up to 15 digits, and one beside it
/// at worst where it has more. `None` where it is none, also for what is infinite.
#[must_use]
pub fn decimal(text: &str) -> Option<f64> {
    let (mantissa, exponent) = match text.find(['e', 'E']) {
        Some(at) => (&text[..at], exponent(&text[at + 1..])?),
        None => (text, 0),
    };
    let (negative, mantissa) = sign(mantissa);
    let (mut value, mut kept, mut exponent, mut any, mut after) = (0_u64, 0, exponent, false, false);
    for byte in mantissa.bytes() {
        match byte {
            b'.' if !after => after = true,
            b'0'..=b'9' => {
                any = true;
                let counts = kept < DIGITS;
                if counts {
                    value = value * 10 + u64::from(byte - b'0');
                    kept += u32::from(value > 0);
                }
                // A digit that is kept behind the point divides, one that is not before it multiplies.
                exponent += i32::from(!counts) - i32::from(after);
            }
            _ => return None,
        }
    }
    let value = scaled(value as f64, exponent);
    (any && value.is_finite()).then_some(if negative { -value } else { value })
}

/// `value` times so many tens: exact where both are.
fn scaled(mut value: f64, mut exponent: i32) -> f64 {
    // Up to here tens are numbers of 64 bits: one multiplication or division rounds once.
    const MOST: i32 = 22;
    while exponent != 0 && value != 0.0 && value.is_finite() {
        let step = exponent.clamp(-MOST, MOST);
        let tens = (0..step.abs()).fold(1.0, |tens, _| tens * 10.0);
        value = if step < 0 { value / tens } else { value * tens };
        exponent -= step;
    }
    value
}

fn sign(text: &str) -> (bool, &str) {
    match text.as_bytes().first() {
        Some(b'-') => (true, &text[1..]),
        Some(b'+') => (false, &text[1..]),
        _ => (false, text),
    }
}

/// A whole number, of which no more than four digits matter.
fn exponent(text: &str) -> Option<i32> {
    let (negative, digits) = sign(text);
    let all = digits
        .bytes()
        .try_fold(0_i32, |sum, byte| byte.is_ascii_digit().then(|| (sum * 10 + i32::from(byte - b'0')).min(9999)))?;
    (!digits.is_empty()).then_some(if negative { -all } else { all })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_those_of_the_library() {
        for text in ["0", "-0", "1", "+1.5", "-12.25", ".5", "5.", "1e3", "1E-4", "-2.5e+2", "0.1", "123456.789012345"]
        {
            let expected: f64 = text.parse().unwrap();
            assert_eq!(decimal(text).map(f64::to_bits), Some(expected.to_bits()), "{text}");
        }
        let mut seed = 7_u64;
        for _ in 0..20_000 {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            let (digits, places) = ((seed >> 12) % 1_000_000_000_000_000, (seed >> 5) % 16);
            let text = format!("{}e-{places}", digits as i64 - 500_000_000_000_000);
            assert_eq!(decimal(&text), text.parse().ok(), "{text}");
            let plain = format!("{:.6}", digits as f64 / 1e9);
            assert_eq!(decimal(&plain), plain.parse().ok(), "{plain}");
        }
    }

    #[test]
    fn long_numbers_are_near_and_nonsense_is_none() {
        for text in ["0.12345678901234567890123", "3.14159265358979323846264338e0", "98765432109876543210.5", "1e-300"]
        {
            let (expected, found): (f64, f64) = (text.parse().unwrap(), decimal(text).unwrap());
            assert!((found / expected - 1.0).abs() < 1e-15, "{text}: {found}");
        }
        for text in
            ["", "-", ".", "e5", "1e", "1e+", "nan", "inf", "1.2.3", "1,5", "0x10", "1 2", "1e9999", "--1", "1e5.5"]
        {
            assert_eq!(decimal(text), None, "{text}");
        }
        assert_eq!((decimal("0e9999"), decimal("1e-9999")), (Some(0.0), Some(0.0)));
    }
}
