! Two laws whose tangent is not symmetric, by the sign of PROPS(1).
! PROPS(1) < 0: linear; the volume strain gives shear, the shear no pressure. PROPS: -, E, nu, coupling.
! PROPS(1) > 0: Drucker and Prager without dilatancy, q + a p = k with p the mean stress. PROPS: a, E, nu, k.
subroutine umat(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, stran, dstran, time, dtime, temp, &
  dtemp, predef, dpred, cmname, ndi, nshr, ntens, nstatv, props, nprops, coords, drot, pnewdt, celent, dfgrd0, dfgrd1, &
  noel, npt, layer, kspt, jstep, kinc)
  include 'aba_param.inc'
  character(80) :: cmname
  dimension stress(ntens), statev(nstatv), ddsdde(ntens, ntens), ddsddt(ntens), drplde(ntens), stran(ntens), &
    dstran(ntens), time(2), predef(1), dpred(1), props(nprops), coords(3), drot(3, 3), dfgrd0(3, 3), dfgrd1(3, 3), jstep(4)
  dimension s(ntens), unit(ntens)
  e = props(2)
  g = e / (2 * (1 + props(3)))
  bulk = e / (3 * (1 - 2 * props(3)))
  unit = 0
  unit(:ndi) = 1
  ddsdde = 0
  do i = 1, ndi
    ddsdde(:ndi, i) = bulk - 2 * g / 3
  end do
  do i = 1, ntens
    ddsdde(i, i) = ddsdde(i, i) + g * merge(2, 1, i <= ndi)
  end do
  if (props(1) < 0) then
    ddsdde(ndi + 1, :ndi) = ddsdde(ndi + 1, :ndi) + props(4) * e
    ddsdde(1, :ndi) = ddsdde(1, :ndi) + props(4) * e
    stress = stress + matmul(ddsdde, dstran)
    return
  end if
  stress = stress + matmul(ddsdde, dstran)
  p = sum(stress(:ndi)) / 3
  s = stress - p * unit
  q = sqrt(1.5d0 * (sum(s(:ndi)**2) + 2 * sum(s(ndi + 1:)**2)))
  cap = props(4) - props(1) * p
  if (q <= cap) return
  stress = p * unit + cap / q * s
  do i = 1, ntens
    do j = 1, ntens
      deviator = -unit(i) * unit(j) * 2 * g / 3
      if (i == j) deviator = deviator + g * merge(2, 1, i <= ndi)
      ddsdde(i, j) = bulk * unit(i) * unit(j) + cap / q * deviator &
        - s(i) / q * (props(1) * bulk * unit(j) + 3 * g * cap / q**2 * s(j))
    end do
  end do
end subroutine umat
