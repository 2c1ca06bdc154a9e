//! The functions of real numbers that ufbx calls, under the names that it gives them
//! (`UFBX_EXTERNAL_MATH` in ufbx.c). Those of the C library differ between machines in their last
//! bits.

#![expect(unsafe_code, reason = "C calls these functions by name")]

use std::ffi::c_int;

/// Defines functions of real numbers by those of `libm`.
macro_rules! math {
    ($($name:ident = $libm:ident($($x:ident),+);)+) => {$(
        // SAFETY: no other symbol has this prefix, and plain numbers are passed.
        #[unsafe(no_mangle)]
        extern "C" fn $name($($x: f64),+) -> f64 {
            libm::$libm($($x),+)
        }
    )+};
}

math! {
    ufbx_sqrt = sqrt(x);
    ufbx_sin = sin(x);
    ufbx_cos = cos(x);
    ufbx_tan = tan(x);
    ufbx_asin = asin(x);
    ufbx_acos = acos(x);
    ufbx_atan = atan(x);
    ufbx_atan2 = atan2(y, x);
    ufbx_pow = pow(x, y);
    ufbx_fmin = fmin(x, y);
    ufbx_fmax = fmax(x, y);
    ufbx_fabs = fabs(x);
    ufbx_copysign = copysign(x, y);
    ufbx_nextafter = nextafter(x, y);
    ufbx_rint = rint(x);
    ufbx_floor = floor(x);
    ufbx_ceil = ceil(x);
}

// SAFETY: no other symbol has this prefix, and a plain number is passed.
#[unsafe(no_mangle)]
extern "C" fn ufbx_isnan(x: f64) -> c_int {
    c_int::from(x.is_nan())
}
