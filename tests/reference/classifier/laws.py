"""Writes laws.csv: the laws of classifier.h to 40 digits (mpmath). Run: python3 laws.py > laws.csv"""
from mpmath import mp, mpf, log, log10, exp, sqrt, cbrt, pi, quad, findroot, atan, erfc, lambertw, linspace

mp.dps = 40
rho_f, eta, rho_p, radius = mpf("1.2"), mpf("1.81e-5"), mpf(2700), mpf("0.025")


def double(text):  # exactly the number that a C program reads
    return mpf(float(text))


def factor(psi):
    return mpf(10) ** (mpf("0.4") * (-log10(psi)) ** mpf("0.2")) if psi < 1 else mpf(1)


def hs(re, psi):
    return (8 / re / sqrt(psi) + 16 / re / sqrt(psi) + 3 / sqrt(re) / psi ** mpf("0.75")
            + mpf("0.42") * factor(psi) / psi)


def sn(re):
    return 24 / re * (1 + mpf("0.15") * re ** mpf("0.687"))


def root(f, low, high):  # zero between them, in ln x
    return exp(findroot(lambda l: f(exp(l)), (log(low), log(high)), solver="anderson", tol=mpf(10) ** -36,
                        maxsteps=2000))


def row(name, *values):
    print(name + ","
          + ",".join(mp.nstr(v, 20, strip_zeros=False) if v != "" else ""
                     for v in (list(values[:-1]) + [""] * (3 - len(values[:-1])))) + "," + mp.nstr(values[-1], 22))


print("# classifier.h's laws to 20 digits, made by laws.py (mpmath, 40 digits). rho_f 1.2, eta 1.81e-5, rho_p 2700, "
      "r 0.025, SI")
print("law,a,b,c,value")
for psi in ("1", "0.99999", "0.9999", "0.99", "0.85", "0.7", "0.5", "0.1", "1e-3"):
    row("newton_factor", double(psi), factor(double(psi)))
    for re in ("1e-8", "1e-3", "1", "50", "100", "1e4", "1e6"):
        row("hoelzer_sommerfeld", double(re), double(psi), hs(double(re), double(psi)))
for re in ("1e-6", "0.1", "1", "50", "500", "1000"):
    row("schiller_naumann", double(re), sn(double(re)))
for re in ("1e-6", "1", "31.6227766016838", "50", "1e5"):
    z = mpf("1.5") - log10(double(re))
    row("di_felice", double(re), mpf("3.7") - mpf("0.65") * exp(-z * z / 2))
for psi in ("1", "0.85", "0.5", "0.05"):
    for v_rad, v_phi in (("7.1", "7.85398163397448"), ("7.1", "39.2699081698724"), ("30", "10"), ("0.01", "20"),
                         ("1e-5", "50"), ("300", "1")):
        v_r, v_p, p = double(v_rad), double(v_phi), double(psi)
        K, a = mpf(3) / 4 * rho_f / rho_p * radius * v_r**2 / v_p**2, rho_f * v_r / eta
        row("cut_size", v_r, v_p, p, root(lambda x: log(x / (K * hs(a * x, p))), mpf("1e-14"), mpf("1e6")))
    for x in ("1e-7", "2e-5", "1e-4", "1e-3"):
        X, p = double(x), double(psi)
        v = root(lambda v: log(v * v * mpf(3) / 4 * hs(rho_f * v * X / eta, p) * rho_f
                               / (X * (rho_p - rho_f) * mpf("9.81"))), mpf("1e-15"), mpf("1e4"))
        row("terminal_velocity", X, p, v)
    for x, v0 in (("2e-5", "39"), ("1e-6", "1e-3"), ("1e-7", "1e-6"), ("1e-3", "100"), ("5e-5", "1")):
        X, p, V = double(x), double(psi), double(v0)
        re = rho_f * V * X / eta
        S = 4 * rho_p * X / (3 * rho_f) * quad(lambda u: 2 * u / (hs(u * u, p) * u * u) if u else mpf(0),
                                               [0, sqrt(re) / 100, sqrt(re) / 10, sqrt(re)])
        row("stopping_distance", X, V, p, S)
for x, v0 in (("2e-5", "39"), ("1e-6", "1e-3"), ("1e-3", "100")):
    X, V = double(x), double(v0)
    re = rho_f * V * X / eta
    top = min(re, mpf(1000))
    S = quad(lambda q: 3 * q * q / (24 + mpf("3.6") * q ** mpf("2.061")),
             linspace(0, cbrt(top), 9)) + (log(re / top) / mpf("0.44"))
    row("stopping_schiller_naumann", X, V, 4 * rho_p * X / (3 * rho_f) * S)
for x in ("1e-7", "2e-5", "1e-4"):
    X = double(x)
    v = root(lambda v: log(v * v * mpf(3) / 4 * sn(rho_f * v * X / eta) * rho_f / (X * (rho_p - rho_f) * mpf("9.81"))),
             mpf("1e-15"), mpf("1e4"))
    row("terminal_schiller_naumann", X, v)
for z in ("-6", "-1.3", "-0.2", "0.1", "0.66", "0.7", "2", "5.6", "5.7", "8", "20"):
    row("normal_above", double(z), erfc(double(z) / sqrt(2)) / 2)
for r in ("0.99", "0.5", "0.1", "1e-3"):
    R = double(r)
    row("thornton_ning", R,
        sqrt(6 * sqrt(3) / 5) * sqrt(1 - R * R / 6) * (R / (R + 2 * sqrt(mpf(6) / 5 - R * R / 5))) ** mpf("0.25"))
for t in ("0.001", "0.25", "0.5", "0.75", "0.999"):
    for alpha in ("0.01", "0.5", "5", "50"):
        T, A = double(t), double(alpha)
        row("molerus_hoffmann_size", T, A, sqrt(lambertw(A * exp(A) * T / (1 - T)).real / A))
