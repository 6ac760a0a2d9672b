! Von Mises plasticity in plane stress with linear isotropic hardening: NDI = 2, NSHR = 1 or the job ends.
! PROPS: E, nu, yield stress, hardening modulus. STATEV: equivalent plastic strain.
! The return solves one equation for the multiplier g: stress = (C^-1 + g P)^-1 (trial strain), in the axes of mean stress, half
! difference and shear, where elasticity and P are diagonal.
! Reference: J. C. Simo, T. J. R. Hughes, Computational Inelasticity, Springer 1998, section 3.4.
subroutine umat(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, stran, dstran, time, dtime, temp, &
  dtemp, predef, dpred, cmname, ndi, nshr, ntens, nstatv, props, nprops, coords, drot, pnewdt, celent, dfgrd0, dfgrd1, &
  noel, npt, layer, kspt, jstep, kinc)
  include 'aba_param.inc'
  character(80) :: cmname
  dimension stress(ntens), statev(nstatv), ddsdde(ntens, ntens), ddsddt(ntens), drplde(ntens), stran(ntens), &
    dstran(ntens), time(2), predef(1), dpred(1), props(nprops), coords(3), drot(3, 3), dfgrd0(3, 3), dfgrd1(3, 3), jstep(4)
  dimension q(3), s(3), d(3), weight(3), flow(3), n(3, 3)
  real(8) :: n
  integer :: i, k
  if (ndi /= 2 .or. nshr /= 1 .or. ntens /= 3) call xit
  e = props(1)
  v = props(2)
  ddsdde = 0
  ddsdde(1:2, 1:2) = v * e / (1 - v**2)
  ddsdde(1, 1) = e / (1 - v**2)
  ddsdde(2, 2) = ddsdde(1, 1)
  ddsdde(3, 3) = e / (2 * (1 + v))
  stress = stress + matmul(ddsdde, dstran)
  sse = 0.5d0 / e * (stress(1)**2 + stress(2)**2 - 2 * v * stress(1) * stress(2) + 2 * (1 + v) * stress(3)**2)
  if (nprops < 4) return
  q = [0.5d0 * (stress(1) + stress(2)), 0.5d0 * (stress(1) - stress(2)), stress(3)]   ! of the trial stress
  weight = [1.0d0, 3.0d0, 3.0d0]                   ! Mises^2 = sum weight q^2
  d = [e / (1 - v) / 2, 3 * e / (1 + v) / 2, 3 * e / (1 + v) / 2]   ! q = trial / (1 + g d), g = plastic strain / Mises
  if (sqrt(sum(weight * q**2)) <= (1 + 1.0d-12) * (props(3) + props(4) * statev(1))) return
  g = 0
  do k = 1, 50
    s = q / (1 + g * d)
    size = sqrt(sum(weight * s**2))
    slope = -sum(weight * s**2 * d / (1 + g * d)) / size
    f = size - props(3) - props(4) * (statev(1) + g * size)
    if (abs(f) <= 1.0d-13 * size) exit
    g = g - f / (slope * (1 - props(4) * g) - props(4) * size)
  end do
  stress = [s(1) + s(2), s(1) - s(2), s(3)]
  statev(1) = statev(1) + g * size
  sse = 0.5d0 / e * (stress(1)**2 + stress(2)**2 - 2 * v * stress(1) * stress(2) + 2 * (1 + v) * stress(3)**2)
  ! consistent tangent in these axes, then back
  n = 0
  n(1, 1) = e / (1 - v) / (1 + g * d(1))
  n(2, 2) = e / (1 + v) / (1 + g * d(2))
  n(3, 3) = e / (2 * (1 + v)) / (1 + g * d(3))
  flow = weight * s / size                         ! d Mises / d q
  ! f(q(e, g), g) = 0: flow . (n de + (dq/dg) dg) (1 - H g) - H size dg = 0
  do i = 1, 3
    q(i) = -s(i) * d(i) / (1 + g * d(i))           ! dq/dg
  end do
  denominator = props(4) * size - (1 - props(4) * g) * dot_product(flow, q)
  flow = matmul(flow, n) * (1 - props(4) * g) / denominator   ! dg/de
  do i = 1, 3
    n(:, i) = n(:, i) + q * flow(i)
  end do
  ! e = half sum, half difference of the strains 11 and 22, engineering shear
  do i = 1, 3
    s = 0
    if (i == 1) s = [0.5d0, 0.5d0, 0.0d0]
    if (i == 2) s = [0.5d0, -0.5d0, 0.0d0]
    if (i == 3) s = [0.0d0, 0.0d0, 1.0d0]
    s = matmul(n, s)
    ddsdde(:, i) = [s(1) + s(2), s(1) - s(2), s(3)]
  end do
end subroutine umat
