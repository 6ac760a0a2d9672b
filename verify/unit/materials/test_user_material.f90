!> Unit test of amontons_user_material: a UMAT of Hooke's law, compiled on the spot: increments, rotations, tangents and refusals.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_user_material
  use amontons_errors, only: error_type
  use amontons_elasticity, only: isotropic_tangent
  use amontons_kinds, only: DP
  use amontons_materials, only: material_type, USER_STRESS, USER_STATE, USER_STRAIN
  use amontons_tensor, only: IDENTITY, determinant, pack_voigt, unpack_voigt
  use amontons_user_material, only: umat_point_type, evaluate_umat, find_initial_tangent, transverse_energy, is_deleted, &
    DELETED_STIFFNESS
  use amontons_user_routines, only: umat_type, open_routines, close_routines, has_routine, ROUTINE_UMAT, ROUTINE_DLOAD, &
    ROUTINE_FRIC
  use check, only: suite_type
  implicit none
  type(suite_type) :: suite
  real(DP), parameter :: LAMBDA = 3, G = 2
  real(DP) :: no_fields(0, 2)
  type(material_type) :: material
  call open_umat()
  call check_small()
  call check_finite()
  call check_rotation()
  call check_refusal()
  call check_initial()
  call check_shell()
  call check_deletion()
  call check_missing()
  call suite%finish()

contains

  !> Writes a UMAT and opens it: stress + C dstrain, STATEV(1) counts calls; a strain 11 above 9 is refused.
  subroutine open_umat()
    type(error_type), allocatable :: error
    integer :: unit
    open (newunit=unit, file='test_user_material_umat.f90', status='replace', action='write')
    write (unit, '(a)') 'subroutine umat(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, stran, dstran, &', &
      '  time, dtime, temp, dtemp, predef, dpred, cmname, ndi, nshr, ntens, nstatv, props, nprops, coords, drot, pnewdt, &', &
      '  celent, dfgrd0, dfgrd1, noel, npt, layer, kspt, kstep, kinc)', '  implicit none', &
      '  integer :: ndi, nshr, ntens, nstatv, nprops, noel, npt, layer, kspt, kstep, kinc, i', '  character(80) :: cmname', &
      '  real(8) :: stress(ntens), statev(nstatv), ddsdde(ntens, ntens), sse, spd, scd, rpl, ddsddt(ntens), drplde(ntens)', &
      '  real(8) :: drpldt, stran(ntens), dstran(ntens), time(2), dtime, temp, dtemp, predef(1), dpred(1), props(nprops)', &
      '  real(8) :: coords(3), drot(3, 3), pnewdt, celent, dfgrd0(3, 3), dfgrd1(3, 3)', '  ddsdde = 0', &
      '  ddsdde(:ndi, :ndi) = props(1)', '  do i = 1, ntens', &
      '    ddsdde(i, i) = merge(props(1) + 2 * props(2), props(2), i <= ndi)', '  end do', &
      '  stress = stress + matmul(ddsdde, dstran)', '  if (nstatv > 0) statev(1) = statev(1) + 1', &
      '  if (dstran(1) > 9) pnewdt = 0.5d0', 'end subroutine umat'
    close (unit)
    call open_routines('test_user_material_umat.f90', material%routines, error)
    call suite%that('opened', .not. allocated(error))
    if (allocated(error)) print '(a)', error%message
    call suite%that('it has UMAT alone', has_routine(material%routines, ROUTINE_UMAT) &
      .and. .not. has_routine(material%routines, ROUTINE_DLOAD) .and. .not. has_routine(material%routines, ROUTINE_FRIC))
    material%name = 'HOOKE'
    material%is_user = .true.
    material%props = [LAMBDA, G]
    material%n_statev = 1
  end subroutine open_umat


  !> A point at rest.
  subroutine make_point(user)
    type(umat_point_type), intent(out) :: user
    allocate (user%history_old(USER_STATE - USER_STRESS + 1), source=0.0_DP)
  end subroutine make_point


  !> A law of shells: UMAT gives 11, 22, 12; 13 and 23 have the moduli of the section, 33 is free, at finite strain by the volume.
  subroutine check_shell()
    type(material_type) :: shell
    type(umat_type) :: at_rest
    type(umat_point_type) :: user
    type(error_type), allocatable :: error
    real(DP) :: strain(6), stress(6), c(6, 6), H(3, 3), expected(6)
    logical :: is_accepted
    shell = material
    shell%is_shell_law = .true.
    shell%transverse_shear = reshape([0.5_DP, 0.1_DP, 0.1_DP, 0.7_DP], [2, 2])   ! 13, 23
    at_rest%ndi = 2
    at_rest%nshr = 1
    call find_initial_tangent(shell, at_rest, [0.0_DP], no_fields, error)
    call suite%that('shell at rest', .not. allocated(error))
    call suite%near('33 is as stiff as 11', shell%at_rest(3, 3), LAMBDA + 2 * G, 1.0e-14_DP)
    call suite%near('33 alone', norm2(shell%at_rest([1, 2, 4, 5, 6], 3)), 0.0_DP, 0.0_DP)
    call make_point(user)
    user%values%ndi = 2
    user%values%nshr = 1
    strain = [0.1_DP, -0.2_DP, 0.3_DP, 0.4_DP, 0.5_DP, 0.6_DP]      ! xx yy zz xy yz xz
    H = unpack_voigt(strain)
    call evaluate_umat(shell, .false., H, strain, IDENTITY, user, stress, c, is_accepted)
    expected = [LAMBDA * (-0.1_DP) + 2 * G * 0.1_DP, LAMBDA * (-0.1_DP) - 2 * G * 0.2_DP, (LAMBDA + 2 * G) * 0.3_DP, &
      2 * G * 0.4_DP, 2 * (0.7_DP * 0.5_DP + 0.1_DP * 0.6_DP), 2 * (0.5_DP * 0.6_DP + 0.1_DP * 0.5_DP)]
    call suite%near('stress of a shell', norm2(stress - expected), 0.0_DP, 1.0e-14_DP)
    call suite%near('its energy across', transverse_energy(shell, user%values%stress), 0.5_DP * ((LAMBDA + 2 * G) * 0.09_DP + &
      2 * (expected(5) * 0.5_DP + expected(6) * 0.6_DP)), 1.0e-14_DP)
    call make_point(user)
    user%has_orientation = .true.
    user%values%ndi = 2
    user%values%nshr = 1
    H = 0
    H(1, 1) = 0.02_DP
    H(3, 3) = 1 / 1.02_DP - 1
    call evaluate_umat(shell, .true., H, strain, IDENTITY, user, stress, c, is_accepted)
    call suite%near('constant volume: no stress across', stress(3), 0.0_DP, 1.0e-5_DP)
    call suite%that('stress along', stress(1) > 0.02_DP * (LAMBDA + 2 * G) * 0.95_DP)
  end subroutine check_shell


  !> STATEV(1), to which UMAT adds one, deletes the point where it becomes 0: no stress, for good; a small tangent.
  subroutine check_deletion()
    type(material_type) :: fragile
    type(umat_type) :: at_rest
    type(umat_point_type) :: user
    type(error_type), allocatable :: error
    real(DP) :: strain(6), stress(6), c(6, 6), H(3, 3)
    integer :: i
    logical :: is_accepted
    fragile = material
    fragile%deletion = 1
    call find_initial_tangent(fragile, at_rest, [1.0_DP], no_fields, error)
    call suite%that('fragile at rest', .not. allocated(error))
    H = 0
    strain = [0.1_DP, 0.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 0.0_DP]
    call suite%that('deleted', is_deleted(fragile, [0.0_DP]) .and. .not. is_deleted(fragile, [1.0_DP]) .and. &
      .not. is_deleted(material, [0.0_DP]))
    call make_point(user)
    user%history_old(USER_STATE - USER_STRESS + 1) = -1
    do i = 1, 2
      call evaluate_umat(fragile, .false., H, strain, IDENTITY, user, stress, c, is_accepted)
      call suite%that('accepted without stress', is_accepted .and. all(abs(stress) <= 0.0_DP))
      call suite%near('small tangent', norm2(c - DELETED_STIFFNESS * isotropic_tangent(LAMBDA, G)), 0.0_DP, 1.0e-14_DP)
      call suite%near('STATEV stays', user%history(USER_STATE - USER_STRESS + 1), 0.0_DP, 0.0_DP)
      user%history_old = user%history
    end do
  end subroutine check_deletion


  !> Small strain: Hooke's law in our order of components, the strain and the count in the history.
  subroutine check_small()
    type(umat_point_type) :: user
    real(DP) :: strain(6), stress(6), c(6, 6), H(3, 3), engineering(6)
    logical :: is_accepted
    call make_point(user)
    user%history_old(USER_STATE - USER_STRESS + 1) = 4
    H = 0
    strain = [0.1_DP, -0.2_DP, 0.3_DP, 0.4_DP, 0.5_DP, 0.6_DP]
    engineering = strain
    engineering(4:) = 2 * strain(4:)
    call evaluate_umat(material, .false., H, strain, IDENTITY, user, stress, c, is_accepted)
    call suite%that('accepted', is_accepted)
    call suite%near('tangent', norm2(c - isotropic_tangent(LAMBDA, G)), 0.0_DP, 1.0e-14_DP)
    call suite%near('stress', norm2(stress - matmul(isotropic_tangent(LAMBDA, G), engineering)), 0.0_DP, 1.0e-14_DP)
    call suite%near('STATEV', user%history(USER_STATE - USER_STRESS + 1), 5.0_DP, 0.0_DP)
    call suite%near('STRAN is kept, 11 22 33 12 13 23', norm2(user%history(USER_STRAIN - USER_STRESS + 1:USER_STRAIN - USER_STRESS &
      + 6) - engineering([1, 2, 3, 4, 6, 5])), 0.0_DP, 1.0e-14_DP)
    user%history_old = user%history
    call evaluate_umat(material, .false., H, strain, IDENTITY, user, stress, c, is_accepted)
    call suite%near('the same strain again: no increment', norm2(stress - matmul(isotropic_tangent(LAMBDA, G), engineering)), &
      0.0_DP, 1.0e-14_DP)
  end subroutine check_small


  !> Finite strain: the spatial tangent is that of the Lie derivative of tau, for increments from rest that are small.
  subroutine check_finite()
    type(umat_point_type) :: user
    real(DP) :: stress(6), c(6, 6), H(3, 3), D(3, 3), plus(6), minus(6), unused(6, 6), rate(6), tau(3, 3), unit(6)
    real(DP), parameter :: STEP = 1.0e-6_DP
    logical :: is_accepted
    integer :: k
    call make_point(user)
    user%history_old(:6) = [0.5_DP, -0.3_DP, 0.2_DP, 0.1_DP, 0.4_DP, -0.2_DP]
    H = 0
    call evaluate_umat(material, .true., H, [0.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 0.0_DP, 0.0_DP], IDENTITY, user, stress, c, &
      is_accepted)
    call suite%near('no increment: the stress stays, in our order', norm2(stress - [0.5_DP, -0.3_DP, 0.2_DP, 0.1_DP, -0.2_DP, &
      0.4_DP]), 0.0_DP, 1.0e-14_DP)
    tau = unpack_voigt(stress)
    do k = 1, 6
      unit = 0
      unit(k) = merge(1.0_DP, 0.5_DP, k <= 3)
      D = unpack_voigt(unit)
      call evaluate_umat(material, .true., STEP * D, unit, IDENTITY, user, plus, unused, is_accepted)
      call evaluate_umat(material, .true., -STEP * D, unit, IDENTITY, user, minus, unused, is_accepted)
      rate = (plus - minus) / (2 * STEP) - pack_voigt(matmul(D, tau) + matmul(tau, D))
      ! DDSDDE of this UMAT is that of Cauchy's stress; (1/J) d(J s) of Jaumann's rate has the trace besides
      rate = rate - merge(stress, 0 * stress, k <= 3)
      call suite%near('Lie derivative', norm2(c(:, k) - rate), 0.0_DP, 1.0e-8_DP)
    end do
  end subroutine check_finite


  !> A rotation turns the stress and strains nothing; Kirchhoff's stress is J times that of UMAT.
  subroutine check_rotation()
    type(umat_point_type) :: user
    real(DP) :: stress(6), c(6, 6), R(3, 3), expected(3, 3), zero(6)
    logical :: is_accepted
    call make_point(user)
    zero = 0
    user%history_old(:6) = [5.0_DP, 1.0_DP, 2.0_DP, 0.0_DP, 0.0_DP, 0.0_DP]
    R = reshape([0.6_DP, 0.8_DP, 0.0_DP, -0.8_DP, 0.6_DP, 0.0_DP, 0.0_DP, 0.0_DP, 1.0_DP], [3, 3])
    call evaluate_umat(material, .true., R - IDENTITY, zero, IDENTITY, user, stress, c, is_accepted)
    expected = matmul(R, matmul(unpack_voigt([5.0_DP, 1.0_DP, 2.0_DP, 0.0_DP, 0.0_DP, 0.0_DP]), transpose(R)))
    call suite%near('turned with the body', norm2(unpack_voigt(stress) - expected), 0.0_DP, 1.0e-13_DP)
    call suite%near('no strain', norm2(user%values%dstran), 0.0_DP, 1.0e-14_DP)
    user%history_old(:6) = 0
    call evaluate_umat(material, .true., 0.2_DP * IDENTITY, zero, IDENTITY, user, stress, c, is_accepted)
    call suite%near('J times the stress', stress(1), 1.728_DP * (3 * LAMBDA + 2 * G) * 0.2_DP / 1.1_DP, 1.0e-13_DP)
  end subroutine check_rotation


  !> PNEWDT below 1 refuses the increment.
  subroutine check_refusal()
    type(umat_point_type) :: user
    real(DP) :: stress(6), c(6, 6), H(3, 3), strain(6)
    logical :: is_accepted
    call make_point(user)
    H = 0
    strain = 0
    strain(1) = 10
    call evaluate_umat(material, .false., H, strain, IDENTITY, user, stress, c, is_accepted)
    call suite%that('refused', .not. is_accepted)
    strain(1) = ieee_nan()
    call evaluate_umat(material, .false., H, strain, IDENTITY, user, stress, c, is_accepted)
    call suite%that('no number', .not. is_accepted)
  end subroutine check_refusal


  !> Not a number.
  real(DP) function ieee_nan()
    use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
    ieee_nan = ieee_value(1.0_DP, ieee_quiet_nan)
  end function ieee_nan


  !> At rest: the tangent of all components, and of a plane what it does not know made up.
  subroutine check_initial()
    type(error_type), allocatable :: error
    type(umat_type) :: at_rest
    real(DP) :: E
    integer :: i
    at_rest%dtime = 0.1_DP
    at_rest%ndi = 3
    at_rest%nshr = 3
    call find_initial_tangent(material, at_rest, [(0.0_DP, i=1, material%n_statev)], no_fields, error)
    call suite%that('no error', .not. allocated(error))
    call suite%near('at rest', norm2(material%at_rest - isotropic_tangent(LAMBDA, G)), 0.0_DP, 1.0e-14_DP)
    E = G * (3 * LAMBDA + 2 * G) / (LAMBDA + G)
    call suite%near('E', material%youngs_modulus, E, 1.0e-14_DP)
    call suite%near('nu', material%poissons_ratio, LAMBDA / (2 * (LAMBDA + G)), 1.0e-15_DP)
    at_rest%ndi = 3
    at_rest%nshr = 1
    call find_initial_tangent(material, at_rest, [(0.0_DP, i=1, material%n_statev)], no_fields, error)
    call suite%near('plane strain', norm2(material%at_rest - isotropic_tangent(LAMBDA, G)), 0.0_DP, 1.0e-14_DP)
    at_rest%ndi = 1
    at_rest%nshr = 0
    call find_initial_tangent(material, at_rest, [(0.0_DP, i=1, material%n_statev)], no_fields, error)
    call suite%near('a bar: E is its c 11', material%youngs_modulus, LAMBDA + 2 * G, 1.0e-13_DP)
  end subroutine check_initial


  !> A file that is not there is reported, and a closed library has nothing.
  subroutine check_missing()
    type(material_type) :: other
    type(error_type), allocatable :: error
    integer :: unit
    call open_routines('there_is_no_such_file.f90', other%routines, error)
    call suite%that('an error', allocated(error))
    call close_routines(material%routines)
    open (newunit=unit, file='test_user_material_umat.f90', status='old')
    close (unit, status='delete')
    call suite%that('closed', .not. has_routine(material%routines, ROUTINE_UMAT))
  end subroutine check_missing

end program test_user_material
