! Neo-Hookean rubber of Abaqus' form, W = C10 (J^(-2/3) tr b - 3) + (J - 1)^2 / D1, from the whole deformation.
! PROPS: C10, D1. DDSDDE is (1/J) d(J s) of Jaumann's rate. Free form; one warning, in STDB_ABQERR, when stretched far.
subroutine umat(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, stran, dstran, time, dtime, temp, &
  dtemp, predef, dpred, cmname, ndi, nshr, ntens, nstatv, props, nprops, coords, drot, pnewdt, celent, dfgrd0, dfgrd1, &
  noel, npt, layer, kspt, jstep, kinc)
  include 'aba_param.inc'
  character(80) :: cmname
  dimension stress(ntens), statev(nstatv), ddsdde(ntens, ntens), ddsddt(ntens), drplde(ntens), stran(ntens), &
    dstran(ntens), time(2), predef(1), dpred(1), props(nprops), coords(3), drot(3, 3), dfgrd0(3, 3), dfgrd1(3, 3), jstep(4)
  real(8) :: f(3, 3), b(3, 3), unit(3, 3), det, mean, g, bulk
  integer :: row(6), column(6), i, j, k, l, m, n
  row = [1, 2, 3, 1, 1, 2]
  column = [1, 2, 3, 2, 3, 3]
  f = dfgrd1
  det = f(1, 1) * (f(2, 2) * f(3, 3) - f(2, 3) * f(3, 2)) - f(1, 2) * (f(2, 1) * f(3, 3) - f(2, 3) * f(3, 1)) &
    + f(1, 3) * (f(2, 1) * f(3, 2) - f(2, 2) * f(3, 1))
  b = matmul(f, transpose(f)) * det**(-2.0d0 / 3)
  unit = 0
  do i = 1, 3
    unit(i, i) = 1
  end do
  mean = (b(1, 1) + b(2, 2) + b(3, 3)) / 3
  g = 2 * props(1) / det
  bulk = 2 / props(2)
  do m = 1, 6
    i = row(m)
    j = column(m)
    stress(m) = g * (b(i, j) - mean * unit(i, j)) + bulk * (det - 1) * unit(i, j)
    do n = 1, 6
      k = row(n)
      l = column(n)
      ddsdde(m, n) = g * (0.5d0 * (unit(i, k) * b(j, l) + unit(i, l) * b(j, k) + unit(j, k) * b(i, l) + unit(j, l) * b(i, k)) &
        - 2.0d0 / 3 * (b(i, j) * unit(k, l) + unit(i, j) * b(k, l)) + 2.0d0 / 3 * unit(i, j) * unit(k, l) * mean) &
        + bulk * (2 * det - 1) * unit(i, j) * unit(k, l)
    end do
  end do
  sse = props(1) * (3 * mean - 3) + (det - 1)**2 / props(2)
end subroutine umat
