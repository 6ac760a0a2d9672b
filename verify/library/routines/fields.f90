! UMAT beside USDFLD: elasticity without Poisson's ratio, E = PROPS(1) (1 + PREDEF(1) + DPRED(1)); STATEV(1) becomes 0 where the
! strain 11 exceeds PROPS(2), if that is positive; STATEV(2) is the strain 11, STATEV(3) that by USDFLD, STATEV(4) PREDEF(1).
subroutine umat(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, stran, dstran, time, dtime, temp, &
  dtemp, predef, dpred, cmname, ndi, nshr, ntens, nstatv, props, nprops, coords, drot, pnewdt, celent, dfgrd0, dfgrd1, &
  noel, npt, layer, kspt, jstep, kinc)
  include 'aba_param.inc'
  character(80) :: cmname
  dimension stress(ntens), statev(nstatv), ddsdde(ntens, ntens), ddsddt(ntens), drplde(ntens), stran(ntens), &
    dstran(ntens), time(2), predef(*), dpred(*), props(nprops), coords(3), drot(3, 3), dfgrd0(3, 3), dfgrd1(3, 3), jstep(4)
  e = props(1) * (1 + predef(1) + dpred(1))
  ddsdde = 0
  do i = 1, ntens
    ddsdde(i, i) = merge(e, e / 2, i <= ndi)
  end do
  stress = matmul(ddsdde, stran + dstran)
  sse = 0.5d0 * dot_product(stress, stran + dstran)
  if (nstatv < 4) return
  if (props(2) > 0 .and. stran(1) + dstran(1) > props(2)) statev(1) = 0
  statev(2) = stran(1) + dstran(1)
  statev(4) = predef(1)
end subroutine umat

! FIELD(1) is minus half the strain 11 at the start of the increment over PROPS(2) = 0.01, at most 1/2.
subroutine usdfld(field, statev, pnewdt, direct, t, celent, time, dtime, cmname, orname, nfield, nstatv, noel, npt, layer, kspt, &
  kstep, kinc, ndi, nshr, coord, jmac, jmatyp, matlayo, laccfla)
  include 'aba_param.inc'
  character(80) :: cmname, orname
  character(3) :: flgray(15)
  dimension field(nfield), statev(nstatv), direct(3, 3), t(3, 3), time(2), coord(*), jmac(*), jmatyp(*), array(15), jarray(15)
  call getvrm('E', array, jarray, flgray, jrcd, jmac, jmatyp, matlayo, laccfla)
  field(1) = -0.5d0 * min(1.0d0, array(1) / 0.01d0)
  statev(3) = statev(3) + 1
end subroutine usdfld
