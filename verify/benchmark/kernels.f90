!> Kernels: how fast the elements, the factor and the matrix product below it are, by themselves, on one thread.
!!
!!     kernels DECK
!!
!! The deck is one with linear hexahedra (bench.py --kernels writes a cube). Elements are computed with NLGEOM in a state that is a
!! little deformed; forces are stresses, strains, energies and nodal forces; the stiffness is put into the matrix of all unknowns. Each figure is
!! the best of several runs: other work on the machine only makes it worse.
program kernels
  use, intrinsic :: iso_fortran_env, only: int64, output_unit
  use omp_lib, only: omp_set_num_threads
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type, diagnostic_list_type
  use amontons_model, only: model_type, job_options_type
  use amontons_deck, only: read_deck
  use amontons_state, only: state_type
  use amontons_equilibrium, only: equilibrium_type, create_equilibrium
  use amontons_assembly, only: assemble_forces, assemble_tangent
  use amontons_graph_partition, only: order_unknowns
  use amontons_factorization, only: cholesky_type, analyse, factorise, solve, set_blas_threads, choose_blas_kernels
  implicit none

  integer, parameter :: RUNS = 5
  integer, parameter :: EDGE = 1500                !< of the matrices of the product
  ! Multiplications and additions of a hexahedron with its eight points, counted for an isotropic law: gradients, inverse, F and stress
  ! some 690 a point, and 24 of both for each of the 36 pairs of nodes.
  real(DP), parameter :: WORK = 8 * (690.0_DP + 36 * 48)

  type(model_type) :: model
  type(equilibrium_type) :: system
  type(state_type) :: state
  type(error_type), allocatable :: error
  character(:), allocatable :: processor
  real(DP) :: product_rate

  call omp_set_num_threads(1)
  call choose_blas_kernels(processor)
  call set_blas_threads(1)
  call prepare()
  call time_product()
  call time_elements()
  call time_factor()

contains

  !> The model and its state, a little deformed.
  subroutine prepare()
    type(job_options_type) :: options
    type(diagnostic_list_type) :: complaints
    character(1000) :: path
    integer :: i
    call get_command_argument(1, path)
    options%deck = trim(path)
    options%n_threads = 1
    call read_deck(options, model, complaints, error)
    if (.not. allocated(error)) call create_equilibrium(system, model, state, error)
    if (allocated(error)) error stop error%message
    do i = 1, model%mesh%n_nodes
      state%new%u(:, i) = 1.0e-3_DP * sin(model%mesh%coordinates([2, 3, 1], i) + [0.1_DP, 0.2_DP, 0.3_DP])
    end do
  end subroutine prepare


  !> dgemm, the measure of what the processor can do.
  subroutine time_product()
    real(DP), allocatable :: a(:, :), b(:, :), c(:, :)
    real(DP) :: best, start
    integer :: k
    interface
      subroutine dgemm(ta, tb, m, n, k, alpha, a, lda, b, ldb, beta, c, ldc)
        import :: DP
        character(1), intent(in) :: ta, tb
        integer, intent(in) :: m, n, k, lda, ldb, ldc
        real(DP), intent(in) :: alpha, beta, a(lda, *), b(ldb, *)
        real(DP), intent(inout) :: c(ldc, *)
      end subroutine dgemm
    end interface
    allocate (a(EDGE, EDGE), b(EDGE, EDGE), c(EDGE, EDGE))
    call random_number(a)
    call random_number(b)
    c = 0.0_DP
    best = huge(best)
    do k = 1, RUNS
      start = seconds()
      call dgemm('N', 'N', EDGE, EDGE, EDGE, 1.0_DP, a, EDGE, b, EDGE, 1.0_DP, c, EDGE)
      best = min(best, seconds() - start)
    end do
    product_rate = 2.0_DP * real(EDGE, DP)**3 / best
    write (output_unit, '(a,i0,a,f0.1,a)') 'dgemm ', EDGE, ': ', product_rate / 1.0e9_DP, ' GFLOP/s'
  end subroutine time_product


  !> Forces, and stiffness with its way into the matrix.
  subroutine time_elements()
    real(DP) :: forces, tangent, start
    integer :: k, failed
    forces = huge(forces)
    tangent = huge(tangent)
    do k = 1, RUNS
      start = seconds()
      call assemble_forces(system%assembly, model, .true., state, failed)
      forces = min(forces, seconds() - start)
      if (failed /= 0) error stop 'an element failed'
      start = seconds()
      call assemble_tangent(system%assembly, model, .true., state, failed)
      tangent = min(tangent, seconds() - start)
      if (failed /= 0) error stop 'an element failed'
    end do
    call print_time('forces', forces)
    call print_time('stiffness', tangent)
    write (output_unit, '(a,i0,a)') 'stiffness: ', nint(100 * WORK * real(model%mesh%n_elements, DP) / tangent / product_rate), &
      ' % of what dgemm makes of its arithmetic'
  end subroutine time_elements


  !> A rate of elements.
  subroutine print_time(what, time)
    character(*), intent(in) :: what
    real(DP), intent(in) :: time                   !< [s]
    write (output_unit, '(a,a,i0,a)') what, ': ', nint(real(model%mesh%n_elements, DP) / time / 1000), ' thousand elements a second'
  end subroutine print_time


  !> Factor and solution, the diagonal being a little larger so that the body stands.
  subroutine time_factor()
    type(cholesky_type) :: factor
    integer, allocatable :: order(:)
    real(DP), allocatable :: shift(:), x(:), y(:)
    real(DP) :: ordering, analysis, first, best, solution, start
    integer :: k, status, n
    associate (matrix => system%assembly%stiffness)
      n = matrix%n_rows
      start = seconds()
      call order_unknowns(matrix, [((k + 2) / 3, k=1, n)], n / 3, order, error)
      ordering = seconds() - start
      start = seconds()
      call analyse(factor, matrix, order, error)
      analysis = seconds() - start
      shift = 1.0e-3_DP * abs(matrix%value(matrix%first(:n)))
      best = huge(best)
      do k = 1, 3
        start = seconds()
        call factorise(factor, matrix, status, shift, error)
        if (k == 1) first = seconds() - start
        best = min(best, seconds() - start)
      end do
      allocate (x(n), y(n), source=1.0_DP)
      solution = huge(solution)
      do k = 1, RUNS
        start = seconds()
        call solve(factor, x, y)
        solution = min(solution, seconds() - start)
      end do
    end associate
    write (output_unit, '(a,i0,a,f4.2,a,f4.2,a)') 'factor of ', n, ' unknowns: order ', ordering, ' s, analysis ', analysis, ' s'
    write (output_unit, '(a,f4.2,a,f4.2,a,f0.1,a,i0,a)') 'numbers: first ', first, ' s, again ', best, ' s, ', &
      factor%n_operations / best / 1.0e9_DP, ' GFLOP/s, ', nint(100 * factor%n_operations / best / product_rate), ' % of dgemm'
    write (output_unit, '(a,f5.3,a,f0.1,a)') 'solution: ', solution, ' s, ', 16.0e-9_DP * factor%n_entries / solution, &
      ' GB/s of the factor'
  end subroutine time_factor


  !> Seconds of the processor.
  real(DP) function seconds()
    call cpu_time(seconds)
  end function seconds

end program kernels
