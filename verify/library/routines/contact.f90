!> Routines of a user for contact: FRIC that is *FRICTION with a stick slope, or exact, and UINTER that is LINEAR with friction.
!! SPDX-License-Identifier: GPL-3.0-or-later

!> PROPS: mu, stick slope; without a slope sticking is exact (LM = 1). STATEV: elastic slip.
subroutine fric(lm, tau, ddtddg, ddtddp, dslip, sed, sfd, ddtddt, pnewdt, statev, dgam, taulm, press, dpress, ddpddh, slip, &
  kstep, kinc, time, dtime, noel, ciname, slname, msname, npt, node, npatch, coords, rcoord, drot, temp, predef, nfdir, mcrd, &
  npred, nstatv, chrlngth, props, nprops)
  include 'aba_param.inc'
  character(80) :: ciname, slname, msname
  dimension tau(nfdir), ddtddg(nfdir, nfdir), ddtddp(nfdir), dslip(nfdir), ddtddt(nfdir, 2), statev(*), dgam(nfdir), &
    taulm(nfdir), slip(nfdir), time(2), coords(mcrd), rcoord(mcrd), drot(2, 2), temp(2), predef(2, *), props(nprops)
  dimension e(2), q(2)
  cap = props(1) * press
  if (nprops == 1) then
    size = sqrt(dot_product(dgam, dgam))
    pull = sqrt(dot_product(taulm, taulm))
    if (lm == 0 .and. dot_product(taulm, dgam) < 0 .or. lm /= 0 .and. pull <= cap) then
      lm = 1
      return
    end if
    lm = 0
    ddtddg = 0
    q(:nfdir) = taulm / max(pull, 1d-300)           ! it begins to slip the way it is pulled
    if (size > 0) then
      q(:nfdir) = dgam / size
      do i = 1, nfdir
        ddtddg(:, i) = -cap / size * q(:nfdir) * q(i)
        ddtddg(i, i) = ddtddg(i, i) + cap / size
      end do
    end if
    tau = cap * q(:nfdir)
    ddtddp = props(1) * q(:nfdir)
    dslip = dgam
    return
  end if
  lm = 0
  e(:nfdir) = statev(1:nfdir) + dgam
  size = sqrt(dot_product(e(:nfdir), e(:nfdir)))
  ddtddg = 0
  ddtddp = 0
  dslip = 0
  do i = 1, nfdir
    ddtddg(i, i) = props(2)
  end do
  if (props(2) * size > cap) then
    q(:nfdir) = e(:nfdir) / size
    do i = 1, nfdir
      do j = 1, nfdir
        ddtddg(i, j) = -cap / size * q(i) * q(j)
      end do
      ddtddg(i, i) = ddtddg(i, i) + cap / size
    end do
    ddtddp = props(1) * q(:nfdir)
    dslip = e(:nfdir) - cap / props(2) * q(:nfdir)
    e(:nfdir) = cap / props(2) * q(:nfdir)
  end if
  tau = props(2) * e(:nfdir)
  statev(1:nfdir) = e(:nfdir)
  sfd = dot_product(tau, dslip)
end subroutine fric


!> PROPS: stiffness, mu, stick slope. STATEV: elastic slip.
subroutine uinter(stress, ddsddr, dviscous, dstructural, flux, ddfddt, ddsddt, ddfddr, statev, sed, sfd, spd, svd, scd, pnewdt, &
  rdisp, drdisp, temp, dtemp, predef, dpred, time, dtime, freqr, ciname, slname, msname, props, coords, alocaldir, drot, area, &
  chrlngth, node, ndir, nstatv, npred, nprops, mcrd, kstep, kinc, kit, linper, lopenclose, lstate, lsdi, lprint)
  include 'aba_param.inc'
  character(80) :: ciname, slname, msname
  dimension stress(ndir), ddsddr(ndir, ndir), dviscous(ndir, ndir), dstructural(ndir, ndir), flux(2), ddfddt(2, 2), &
    ddsddt(ndir, 2), ddfddr(2, ndir), statev(nstatv), rdisp(ndir), drdisp(ndir), temp(2), dtemp(2), predef(2, npred), &
    dpred(2, npred), time(2), props(nprops), coords(mcrd), alocaldir(3, 3), drot(2, 2)
  dimension e(2), q(2)
  m = ndir - 1
  stress = 0
  sed = 0
  sfd = 0
  lopenclose = 0
  if (rdisp(1) <= 0) then
    statev = 0
    return
  end if
  lopenclose = 1
  stress(1) = props(1) * rdisp(1)
  ddsddr(1, 1) = props(1)
  e(:m) = statev(1:m) + drdisp(2:)
  cap = props(2) * stress(1)
  size = sqrt(dot_product(e(:m), e(:m)))
  do i = 1, m
    ddsddr(i + 1, i + 1) = props(3)
  end do
  if (props(3) * size > cap) then
    q(:m) = e(:m) / size
    do i = 1, m
      do j = 1, m
        ddsddr(i + 1, j + 1) = -cap / size * q(i) * q(j)
      end do
      ddsddr(i + 1, i + 1) = ddsddr(i + 1, i + 1) + cap / size
      ddsddr(i + 1, 1) = props(2) * props(1) * q(i)
    end do
    sfd = cap * (size - cap / props(3))
    e(:m) = cap / props(3) * q(:m)
  end if
  stress(2:) = props(3) * e(:m)
  sed = 0.5d0 * (props(1) * rdisp(1)**2 + props(3) * dot_product(e(:m), e(:m)))
  statev(1:m) = e(:m)
end subroutine uinter
