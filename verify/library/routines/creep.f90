! CREEP of power laws, by the name of the material: NORTON rate A q^n, STRAIN (A q^n ((m + 1) e)^m)^(1/(m + 1)) integrated over the
! increment from the virtual time at which a constant stress has crept as far.
! SPDX-License-Identifier: GPL-3.0-or-later
subroutine creep(decra, deswa, statev, serd, ec, esw, p, qtild, temp, dtemp, predef, dpred, time, dtime, cmname, leximp, lend, &
    coords, nstatv, noel, npt, layer, kspt, kstep, kinc)
  implicit none
  character(80) :: cmname
  integer :: leximp, lend, nstatv, noel, npt, layer, kspt, kstep, kinc
  real(8) :: decra(5), deswa(5), statev(*), serd, ec(2), esw(2), p, qtild, temp, dtemp, predef(*), dpred(*), time(3), dtime, &
    coords(*)
  real(8), parameter :: a = 1d-16, n = 4.5d0, m = -0.4d0
  real(8) :: s, virtual, k
  if (lend /= 1 .or. leximp /= 1 .or. nstatv /= 0) call xit
  if (qtild <= 0) return
  s = a * qtild**n
  if (cmname == 'NORTON') then
    decra(1) = s * dtime
    decra(5) = n * s * dtime / qtild
  else if (cmname == 'WARM') then               ! A by the temperature at the end
    decra(1) = (1 + temp / 100) * s * dtime
    decra(5) = (1 + temp / 100) * n * s * dtime / qtild
  else if (cmname == 'STRAIN') then
    k = m + 1
    virtual = (ec(1) * k / s)**(1 / k)
    decra(1) = s / k * (virtual + dtime)**k - ec(1)
    decra(5) = n * s / (k * qtild) * (virtual + dtime)**k - s * (virtual + dtime)**m * n * virtual / (k * qtild)
  else if (cmname == 'BARE') then               ! without derivatives
    decra(1) = s * dtime
  else if (cmname == 'SOLVED') then             ! a rate of the creep strain at the end: s/(1 + ec/1d-5)
    decra(1) = s * dtime / (1 + ec(2) / 1d-5)
    decra(2) = -decra(1) / (1d-5 + ec(2))
    decra(5) = n * decra(1) / qtild
  else if (cmname == 'SWELLING') then
    deswa(1) = 1d-6
  else
    decra(1) = -s * dtime
  end if
end subroutine creep
